/* SPDX-License-Identifier: MIT */
/* What a console reads beside its pages' messages, of any bytes: the query, Host and Origin of a request, a
 * proxy's address, and a dropped file's name with what the reader answers. What is taken is what it says to
 * be; of a file that is refused nothing stays. The first byte says which of them, the second how. */
#include "console/console.h"
#include "fuzz/fuzz_target.h"

#include <dirent.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static const char token[] = "0123456789abcdef";

/* ---- addresses */
/* As a query is read: the first part that begins with t= is the token. */
static void check_query(char *text) {
    const bool fits = hs_console_token_fits(text, token);
    char *next = NULL, *part = strtok_r(text, "&", &next);
    while (part && strncmp(part, "t=", 2) != 0) part = strtok_r(NULL, "&", &next);
    FUZZ_HOLDS(fits == (part && strcmp(part + 2, token) == 0));
}

/* No name but localhost: those of others may be made to lead here. */
static void check_host(const char *host, bool loopback) {
    if (!hs_console_host_is_ours(host, loopback)) return;
    const char *const port = strrchr(host, ':');
    const bool named = strncmp(host, "localhost:", 10) == 0;
    FUZZ_HOLDS(port && strtoul(port + 1, NULL, 10) <= 99999 && strspn(port + 1, "0123456789") > 0);
    FUZZ_HOLDS(named || strspn(host, "0123456789abcdefABCDEF.:[]") == strlen(host));
    FUZZ_HOLDS(!loopback || named || strncmp(host, "127.", 4) == 0 || strncmp(host, "[::1]:", 6) == 0);
    const char *const origin = strrchr(host, ']') ? "http://[::1]:80" : "http://127.0.0.1:80";
    FUZZ_HOLDS(hs_console_origin_is_ours(origin, host) == (strcmp(origin + 7, host) == 0));
}

static void check_behind(const char *address) {
    char origin[64];
    if (!hs_console_behind(address, origin, sizeof origin)) return;
    const size_t length = strlen(origin);
    FUZZ_HOLDS(strncmp(address, origin, length) == 0 && address[length] == '/');
    FUZZ_HOLDS(strncmp(origin, "http://", 7) == 0 || strncmp(origin, "https://", 8) == 0);
    FUZZ_HOLDS(strchr(strstr(origin, "://") + 3, '/') == NULL);
    FUZZ_HOLDS(address[strlen(address) - 1] == '/' && strpbrk(address, "?#\"<> ") == NULL);
}

/* ---- files */
static hs_console_files files;
static int reader = -1; /* who answers */
static char folder[] = "/tmp/fuzz_request_XXXXXX";

static void leave(void) {
    hs_console_drop_close(&files);
    hs_console_files_free(&files);
    (void)rmdir(folder);
}

static void begin(void) {
    int ends[2];
    if (reader >= 0) return;
    if (!mkdtemp(folder) || setenv("TMPDIR", folder, 1) != 0 || atexit(leave) != 0 ||
        socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) != 0)
        abort();
    hs_console_drop_open(&files);
    FUZZ_HOLDS(files.drops);
    files.reader = (uint32_t)ends[0];
    reader = ends[1];
}

/* How many copies there were; none is left. */
static uint32_t clear(void) {
    uint32_t count = 0;
    DIR *all = opendir(files.folder[0]);
    if (!all) abort();
    for (const struct dirent *one; (one = readdir(all)) != NULL;)
        if (strcmp(one->d_name, ".") != 0 && strcmp(one->d_name, "..") != 0) {
            FUZZ_HOLDS(unlinkat(dirfd(all), one->d_name, 0) == 0);
            count++;
        }
    (void)closedir(all);
    return count;
}

/* The question is of three lines, the second a file of the folder. */
static bool was_asked(const char *what) {
    char question[1 << 13];
    const ssize_t came = recv(reader, question, sizeof question - 1, MSG_DONTWAIT);
    if (came <= 0) return false;
    question[came] = '\0';
    const size_t word = strlen(what), length = strlen(files.folder[0]);
    const char *const path = question + word + 1, *const name = path + length + 1;
    FUZZ_HOLDS(strncmp(question, what, word) == 0 && question[word] == '\n');
    FUZZ_HOLDS(strncmp(path, files.folder[0], length) == 0 && path[length] == '/');
    FUZZ_HOLDS(name[0] != '.' && strchr(name, '\n') && !memchr(name, '/', strcspn(name, "\n")));
    return true;
}

static int send_zeros(void *bytes_left, void *out, size_t bytes) {
    uint64_t *const left = bytes_left;
    if (bytes > *left) bytes = (size_t)*left;
    memset(out, 0, bytes);
    *left -= bytes;
    return (int)bytes;
}

static void check_own(const char *made) {
    json_t *root = json_loads(made, 0, NULL);
    FUZZ_HOLDS(json_array_size(json_object_get(root, "paths")) == 1);
    json_decref(root);
}

/* A file of four bytes by a name, of which `how` & 1 come whole. */
static void check_drop(const char *given, const char *answer, size_t length, uint8_t how) {
    char *made = NULL, real[4096];
    hs_error err = {0};
    uint64_t comes = how & 1 ? 4 : 2;
    const bool picture = how & 2, answers = how & 4;
    begin();
    if (answers && send(reader, answer, length, 0) != (ssize_t)length) abort();
    if (!answers && send(reader, "+", 1, 0) != 1) abort();
    const bool ok = (picture ? hs_console_take_picture : hs_console_take_volume)(&files, given, 4, send_zeros,
                                                                                 &comes, &made, &err);
    const bool asked = was_asked(picture ? "dicom" : "read");
    (void)recv((int)files.reader, real, 0, MSG_DONTWAIT | MSG_TRUNC); /* that nobody has asked for */
    FUZZ_HOLDS(ok ? made != NULL : err.code != HS_OK);
    if (ok && asked) FUZZ_HOLDS(strncmp(made, answers ? answer + 1 : "", length ? length - 1 : 0) == 0);
    if (ok && !asked) check_own(made);
    if (hs_console_files_find(&files, 0, given, real, sizeof real, &err))
        FUZZ_HOLDS(strncmp(real, files.folder[0], strlen(files.folder[0])) == 0);
    FUZZ_HOLDS(clear() == (ok && !picture));
    free(made);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size < 2) return 0;
    char *text = malloc(size - 1);
    if (!text) abort();
    memcpy(text, data + 2, size - 2);
    text[size - 2] = '\0';
    const size_t length = strlen(text), behind = length < size - 2 ? length + 1 : length;
    const uint8_t kind = data[0] % 4;
    if (kind == 0) check_query(text);
    if (kind == 1) check_host(text, data[1] & 1);
    if (kind == 2) check_behind(text);
    if (kind == 3) check_drop(text, text + behind, size - 2 - behind, data[1]);
    free(text);
    return 0;
}
