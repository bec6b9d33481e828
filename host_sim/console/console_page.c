/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include "core/progress.h"

#include <malloc.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define LOOK_S 0.5 /* between two looks at the libraries of a page at rest */
#define REST_S 1.0 /* at least, before what a page draws with is another's */
enum { UNDER_WAY = 2, MAX_REFUSED = 64 };

struct hs_console_page {
    const hs_console_shared *shared;
    hs_console_send send;
    void *connection;
    pthread_t thread;
    pthread_mutex_t lock; /* of all that follows but the last three */
    pthread_cond_t changed;
    bool closed;
    bool has_state, has_deed; /* the mailbox: something new lies in it */
    hs_console_state state;
    hs_console_message deed;
    uint64_t frame, seen;     /* sent, and painted by the page */
    uint32_t refused;         /* of hs_console_page_say's thread, and so is */
    hs_console_message heard; /* what it reads: its stack is small */
    hs_console_state now;     /* of the page's own thread: what it draws */
};

/* What the thread has to do next. */
typedef enum { WORK_END, WORK_STATE, WORK_NEXT, WORK_DEED, WORK_LOOK } work;

static struct timespec at_second(double when) {
    const double left = when > hs_now() ? when - hs_now() : 0.0;
    struct timespec at;
    (void)clock_gettime(CLOCK_MONOTONIC, &at);
    at.tv_sec += (time_t)left;
    at.tv_nsec += (long)((left - (double)(time_t)left) * 1e9);
    if (at.tv_nsec >= 1000000000L) {
        at.tv_nsec -= 1000000000L;
        at.tv_sec++;
    }
    return at;
}

/* Waits for work; `due` is when the next volume of what plays is shown. Takes what it finds out of the
 * mailbox. */
static work wait_for_work(hs_console_page *page, double due, hs_console_message *deed) {
    work found = WORK_END;
    const double look = hs_now() + LOOK_S;
    (void)pthread_mutex_lock(&page->lock);
    while (!page->closed) {
        const bool keeps_up = page->frame - page->seen < UNDER_WAY;
        if (keeps_up && page->has_state) {
            page->now = page->state;
            page->has_state = false;
            found = WORK_STATE;
            break;
        }
        if (page->has_deed && !page->has_state) { /* what is asked for is of the state before it */
            *deed = page->deed;
            page->has_deed = false;
            found = WORK_DEED;
            break;
        }
        const double next = page->now.playing ? due : look;
        if (keeps_up && hs_now() >= next) {
            found = page->now.playing ? WORK_NEXT : WORK_LOOK;
            break;
        }
        const struct timespec until = at_second(next);
        if (keeps_up)
            (void)pthread_cond_timedwait(&page->changed, &page->lock, &until);
        else
            (void)pthread_cond_wait(&page->changed, &page->lock);
    }
    (void)pthread_mutex_unlock(&page->lock);
    return found;
}

static uint64_t next_frame(hs_console_page *page) {
    (void)pthread_mutex_lock(&page->lock);
    const uint64_t frame = ++page->frame;
    (void)pthread_mutex_unlock(&page->lock);
    return frame;
}

/* A volume after the other at the wanted speed, or as fast as it goes; what is late is not made up for. */
static double next_due(double due, double speed) {
    const double now = hs_now(), next = due + 1.0 / speed;
    return next < now ? now : next;
}

static void trim(void) {
#ifdef __GLIBC__
    (void)malloc_trim(0); /* what was freed is the system's again, not the next page's */
#endif
}

/* Counts what all pages of the process have drawn. */
static atomic_uint turns;

/* When a page has drawn last: its turn, and when that ended. */
typedef struct {
    unsigned turn;
    double end;
} last_turn;

/* A hand is on one page at a time. The others keep their pictures and their volume; what they draw with,
 * which is most of their memory, they make anew when they need it. */
static void rest_while_others_draw(hs_console_show *show, const last_turn *last) {
    if (atomic_load(&turns) == last->turn || hs_now() - last->end < REST_S) return;
    if (hs_console_show_rest(show)) trim();
}

static void follow(hs_console_page *page, hs_console_show *show) {
    hs_console_message deed;
    last_turn last = {0};
    double due = 0.0;
    uint32_t index = 0;
    bool plays = false, alive = true, slow = false;
    while (alive) {
        const work what = wait_for_work(page, due, &deed);
        if (what == WORK_END) return;
        if (what == WORK_LOOK && !hs_console_show_is_rebuilt(show)) {
            rest_while_others_draw(show, &last);
            continue;
        }
        last.turn = atomic_fetch_add(&turns, 1u) + 1u;
        if (what == WORK_DEED) {
            alive = hs_console_show_deed(show, &deed);
            last.end = hs_now();
            continue;
        }
        if (what == WORK_NEXT) index++;
        if (!page->now.playing || !plays) index = page->now.index;
        if (what == WORK_NEXT || !plays) due = next_due(due, page->now.speed);
        if (what == WORK_STATE) slow = false;
        plays = page->now.playing;
        hs_console_state state = page->now;
        state.hurried |= slow;
        const double start = hs_now();
        alive = hs_console_show_frame(show, &state, index, next_frame(page));
        last.end = hs_now();
        /* What plays slower than it should goes on in drafts. */
        slow |= plays && what == WORK_NEXT && last.end - start > 1.0 / state.speed;
    }
}

static void *run(void *context) {
    hs_console_page *page = context;
    hs_console_show *show = hs_console_show_open(page->shared, page->send, page->connection);
    if (show) follow(page, show);
    hs_console_show_close(show);
    return NULL;
}

static bool start(hs_console_page *page) {
    pthread_condattr_t attributes;
    if (pthread_condattr_init(&attributes) != 0) return false;
    (void)pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    const bool ready = pthread_cond_init(&page->changed, &attributes) == 0;
    (void)pthread_condattr_destroy(&attributes);
    if (!ready) return false;
    (void)pthread_mutex_init(&page->lock, NULL);
    if (pthread_create(&page->thread, NULL, run, page) == 0) return true;
    (void)pthread_mutex_destroy(&page->lock);
    (void)pthread_cond_destroy(&page->changed);
    return false;
}

hs_console_page *hs_console_page_open(const hs_console_shared *shared, hs_console_send send, void *connection,
                                      hs_error *err) {
    hs_console_page *page = calloc(1, sizeof *page);
    if (!page) {
        (void)hs_fail(err, HS_ERR_MEMORY, "page: no memory");
        return NULL;
    }
    page->shared = shared;
    page->send = send;
    page->connection = connection;
    if (start(page)) return page;
    (void)hs_fail(err, HS_ERR_FAILED, "page: no thread could be started");
    free(page);
    return NULL;
}

static void post(hs_console_page *page, const hs_console_message *message) {
    (void)pthread_mutex_lock(&page->lock);
    if (message->says == HS_CONSOLE_SAYS_STATE) {
        page->state = message->state;
        page->has_state = true;
    } else if (message->says == HS_CONSOLE_SAYS_DO) {
        page->deed = *message;
        page->has_deed = true;
    } else if (message->seen > page->seen && message->seen <= page->frame) {
        page->seen = message->seen; /* others are of no frame that was sent */
    }
    (void)pthread_cond_signal(&page->changed);
    (void)pthread_mutex_unlock(&page->lock);
}

bool hs_console_page_say(hs_console_page *page, const char *text, size_t bytes) {
    hs_error err = {0};
    if (hs_console_message_read(text, bytes, &page->heard, &err)) {
        post(page, &page->heard);
        return true;
    }
    char *reply = hs_console_reply_text("refused", err.text);
    const bool sent = reply && page->send(page->connection, false, (const uint8_t *)reply, strlen(reply));
    free(reply);
    return sent && ++page->refused < MAX_REFUSED;
}

void hs_console_page_close(hs_console_page *page) {
    if (!page) return;
    (void)pthread_mutex_lock(&page->lock);
    page->closed = true;
    (void)pthread_cond_signal(&page->changed);
    (void)pthread_mutex_unlock(&page->lock);
    (void)pthread_join(page->thread, NULL);
    (void)pthread_mutex_destroy(&page->lock);
    (void)pthread_cond_destroy(&page->changed);
    free(page);
    trim();
}
