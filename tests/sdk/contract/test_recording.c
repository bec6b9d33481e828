/* SPDX-License-Identifier: MIT */
/*
 * Recordings (sdk/record/): what passes between host and plugin comes back as it was, from every
 * carrier; a ring keeps the last frames; and what is cut off or damaged at any byte is told, and never read
 * as if it were whole.
 */
#include "record/rec.h"
#include "record/rec_item.h"
#include "support/rig.h"

#include <sys/wait.h>
#include <unistd.h>

enum { WIDTH = 21, HEIGHT = 17, SLICES = 14, RAYS = WIDTH * HEIGHT };

typedef struct {
    char path[64];
    rec *recording;
    rig *r;
    uint8_t *volume;
    bool varies;
    uint32_t first, last; /* indices of the frames */
    sv_scanned ranges[RAYS];
    float depth[RAYS]; /* of the last frame */
    uint8_t status[RAYS];
} scene;

/* A call of the plugin, recorded as a host's layer does it. */
#define CALL(s, what, expression, ...)                                                                       \
    do {                                                                                                     \
        rc_call call = {.kind = (what), .plugin = (s)->r->plugin, .sound = true, __VA_ARGS__};               \
        rec_before((s)->recording, &call);                                                                   \
        call.status = (expression);                                                                          \
        rec_after((s)->recording, &call);                                                                    \
    } while (0)

static void open_scene(scene *s, rig *r, const char *options) {
    char error[300] = "";
    memset(s, 0, sizeof *s);
    (void)snprintf(s->path, sizeof s->path, "/tmp/test_recording_%d", (int)getpid());
    s->r = r;
    s->volume = rig_volume(RIG_LAYERS, WIDTH, HEIGHT, SLICES, 5);
    for (uint32_t i = 0; i < RAYS; i++)
        s->ranges[i] = (sv_scanned){(uint16_t)(i % 3), (uint16_t)(SLICES - i % 4)};
    s->recording = rec_open(s->path, options, error, sizeof error);
    if (!s->recording) fail_msg("%s", error);
    CALL(s, RC_CREATE, SV_OK, .start_ns = 7);
}

static void close_scene(scene *s) {
    assert_string_equal(rec_why(s->recording), "");
    rec_close(s->recording);
    s->recording = NULL;
}

enum { SHOWN = 4 }; /* frames in a row that are told to show the same volume */

/* `frames` frames of the volume, handed over this way; in host memory the first voxel tells which. */
static void record_frames(scene *s, rig_format how, uint32_t frames) {
    const sv_plugin *p = s->r->plugin;
    s->last = s->first + frames - 1;
    how.width = WIDTH;
    how.height = HEIGHT;
    how.slices = SLICES;
    how.slab_slices = 6;
    how.extra_w = how.extra_h = how.extra_pitch = 3;
    how.padding = SV_NO_PADDING;
    how.scanned = s->ranges;
    const sv_param_value k = {rig_param(s->r, "kernel"), 0, 11};
    stage *t = rig_stage(s->r, &how, s->volume);
    s->varies = t->format.carrier == SV_CARRIER_HOST;
    CALL(s, RC_ACTIVATE, p->activate(p, &t->format), .format = &t->format);
    for (uint32_t n = s->first; n <= s->last; n++) {
        if (s->varies) t->memory[0][0] = (uint8_t)(100 + n);
        sv_frame frame = stage_frame(t, &k, 1);
        frame.index = n;
        for (int c = 0; c < 9; c += 4) frame.probe_rotation[c] = 1.0f;
        frame.probe_side[2] = -1.0f;
        frame.beams = SV_BEAMS_FAN;
        frame.beam_apex_mm[2] = -57.0f;
        frame.beam_sweep_mm = 23.0f;
        if (n % SHOWN) frame.flags = SV_FRAME_SAME_VOLUME;
        CALL(s, RC_BEGIN, p->begin(p, &frame), .frame = &frame);
        rec_log(s->recording, SV_LOG_INFO, "a line");
        for (uint32_t i = 0; i < t->slab_count; i++) {
            const sv_slab slab = stage_slab(t, i);
            CALL(s, RC_SLAB, p->slab(p, &slab), .slab = &slab);
        }
        sv_stats stats = {.size = sizeof stats};
        const sv_result result = {
            .size = sizeof result, .depth = s->depth, .status = s->status, .stats = &stats};
        CALL(s, RC_END, p->end(p, &result), .result = &result);
    }
    CALL(s, RC_DEACTIVATE, (p->deactivate(p), SV_OK), );
}

/* What a recording holds. */
typedef struct {
    uint32_t kinds[RC_CALLS], logs, plugins, first_index, index, frames, last_maps;
    bool whole;
    char error[400];
} census;

/* Reads all of it, and holds every frame to the volume, the last one to the maps. */
static census read_all(const char *path, const scene *s) {
    static rec_item item;
    census c = {0};
    rec_reader *r = rec_reader_open(path, c.error, sizeof c.error);
    int there = r ? 1 : -1;
    while (r && (there = rec_reader_next(r, &item, c.error, sizeof c.error)) == 1) {
        c.logs += item.type == REC_LOG;
        c.plugins += item.type == REC_PLUGIN;
        if (item.type == REC_CALL) c.kinds[item.kind]++;
        if (item.type == REC_CALL && item.kind == RC_BEGIN && s) {
            c.index = (uint32_t)item.frame.index;
            if (c.frames++ == 0) c.first_index = c.index;
            assert_int_equal(item.value_count, 1);
            assert_true(item.values[0].value == 11 && item.frame.probe_side[2] == -1.0f);
            assert_int_equal(item.frame.flags, item.frame.index % SHOWN ? SV_FRAME_SAME_VOLUME : 0);
            assert_int_equal(item.frame.beams, SV_BEAMS_FAN);
            assert_true(item.frame.beam_apex_mm[2] == -57.0f);
            assert_true(item.frame.beam_sweep_mm == 23.0f);
            assert_int_equal(item.bytes, sizeof s->ranges);
            assert_memory_equal(item.data, s->ranges, sizeof s->ranges);
            if (s->varies) s->volume[0] = (uint8_t)(100 + item.frame.index);
        }
        if (item.type == REC_CALL && item.kind == RC_SLAB && item.voxels && s) {
            assert_int_equal(item.bytes, item.slab.slice_count * RAYS);
            assert_memory_equal(item.data, s->volume + item.slab.first_slice * RAYS, item.bytes);
        }
        if (item.type == REC_RETURN && item.kind == RC_END && item.maps && s) {
            assert_int_equal(item.bytes, RAYS * 5);
            assert_int_equal(item.found.rays, RAYS);
            if (c.index != s->last) continue;
            assert_int_equal(item.maps, 2);
            assert_memory_equal(item.data, s->depth, sizeof s->depth);
            assert_memory_equal(item.data + sizeof s->depth, s->status, sizeof s->status);
            c.last_maps++;
        }
        if (item.type == REC_RETURN && item.kind == RC_DEACTIVATE && s && c.frames) break;
    }
    c.whole = there >= 0;
    rec_reader_close(r);
    return c;
}

/* The same of a recording that is closed, and whole. The file is gone then. */
static census read_whole(const scene *s) {
    const census c = read_all(s->path, s);
    if (!c.whole) fail_msg("%s", c.error);
    assert_int_equal(c.last_maps, 1);
    (void)remove(s->path);
    return c;
}

static void carriers_come_back(void **state) {
    rig *r = *state;
    static const rig_format ways[] = {{.carrier = SV_CARRIER_HOST},
                                      {.carrier = SV_CARRIER_HOST, .in_place = true, .own_queue = true},
                                      {.carrier = SV_CARRIER_BUFFER, .scanned_in_buffer = true},
                                      {.carrier = SV_CARRIER_IMAGE}};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        scene s;
        open_scene(&s, r, NULL);
        record_frames(&s, ways[i], 2);
        close_scene(&s);
        const census c = read_whole(&s);
        assert_int_equal(c.plugins, 1);
        assert_int_equal(c.kinds[RC_BEGIN], 2);
        assert_int_equal(c.kinds[RC_SLAB], 6);
        assert_int_equal(c.kinds[RC_END], 2);
        assert_int_equal(c.logs, 2);
    }
}

/* At least the last N while it runs, exactly these at the end. Before them stay the activation and the frame
 * that brought the volume of the first of them. */
static void a_ring_keeps_the_last(void **state) {
    rig *r = *state;
    static const uint32_t frames[] = {1, 3, 4, 6, 11, 14};
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        scene s;
        open_scene(&s, r, "frames=3");
        record_frames(&s, (rig_format){0}, frames[i]);
        const census running = read_all(s.path, &s);
        assert_true(running.whole);
        const uint32_t expected = frames[i] < 3 ? frames[i] : 3;
        const uint32_t first = frames[i] - expected, brought = first / SHOWN * SHOWN;
        assert_true(running.frames >= expected && running.frames < 8);
        close_scene(&s);
        const census c = read_whole(&s);
        assert_int_equal(c.frames, expected + (brought < first));
        assert_int_equal(c.first_index, brought);
        assert_int_equal(c.index, frames[i] - 1);
        assert_int_equal(c.kinds[RC_ACTIVATE], 1);
        assert_int_equal(c.plugins, 1);
    }
}

/* An activation knows no volume of an earlier one, whatever its first frame is told. */
static void a_ring_keeps_no_volume_of_another_activation(void **state) {
    rig *r = *state;
    scene s;
    open_scene(&s, r, "frames=3");
    record_frames(&s, (rig_format){0}, 2);
    s.first = 1;
    record_frames(&s, (rig_format){0}, 3);
    close_scene(&s);
    const census c = read_whole(&s);
    assert_int_equal(c.frames, 3);
    assert_int_equal(c.first_index, 1);
    assert_int_equal(c.kinds[RC_ACTIVATE], 1);
}

static size_t read_file(const char *path, uint8_t **bytes) {
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    assert_int_equal(fseek(f, 0, SEEK_END), 0);
    const size_t size = (size_t)ftell(f);
    rewind(f);
    *bytes = unit_memory(size);
    assert_int_equal(fread(*bytes, 1, size, f), size);
    (void)fclose(f);
    return size;
}

static void write_file(const char *path, const uint8_t *bytes, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

/* Writes one byte in place. A file that is written anew each time would wait for the disk. */
static void poke(const char *path, size_t at, uint8_t byte) {
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
    assert_int_equal(fputc(byte, f), byte);
    assert_int_equal(fclose(f), 0);
}

/* Every seventh byte is damaged. Up to behind its first frame the file is cut at every byte, and behind it at
 * some. */
static void what_is_not_whole_is_told(void **state) {
    rig *r = *state;
    scene s;
    uint8_t *bytes;
    char error[400] = "";
    open_scene(&s, r, NULL);
    record_frames(&s, (rig_format){0}, 2);
    close_scene(&s);
    const size_t size = read_file(s.path, &bytes);
    for (size_t at = 0; at < size; at += 7) {
        const bool reserved = at >= 12 && at < 16;
        poke(s.path, at, bytes[at] ^ (uint8_t)(1u << at % 8));
        if (read_all(s.path, NULL).whole && !reserved)
            fail_msg("with another byte %zu it is read as whole", at);
        poke(s.path, at, bytes[at]);
    }
    /* Bytes behind its end make it no whole recording. */
    assert_true(read_all(s.path, NULL).whole);
    assert_int_equal(truncate(s.path, (off_t)size + 4), 0);
    assert_false(read_all(s.path, NULL).whole);
    uint32_t frames = 2;
    for (size_t cut = size; cut > 0;) {
        cut -= frames < 2 || cut < 97 ? 1 : 97;
        assert_int_equal(truncate(s.path, (off_t)cut), 0);
        const census c = read_all(s.path, NULL);
        if (c.whole) fail_msg("cut at byte %zu of %zu it is read as whole", cut, size);
        if (!strstr(c.error, s.path)) fail_msg("'%s' does not name the file", c.error);
        frames = c.kinds[RC_BEGIN];
    }
    assert_int_equal(frames, 0);
    (void)remove(s.path);
    assert_null(rec_reader_open(s.path, error, sizeof error));
    assert_non_null(strstr(error, "No such file"));
}

/* A fork writes nothing into the recording. host_sim forks to compile a plugin's kernels beside its own. */
static void a_fork_adds_nothing(void **state) {
    rig *r = *state;
    scene s;
    uint8_t *before, *after;
    open_scene(&s, r, "frames=3");
    record_frames(&s, (rig_format){0}, 1);
    const size_t size = read_file(s.path, &before);
    const pid_t child = fork();
    if (child == 0) {
        CALL(&s, RC_DEACTIVATE, SV_OK, );
        rec_log(s.recording, SV_LOG_INFO, "from elsewhere");
        rec_close(s.recording);
        _exit(0);
    }
    int status = -1;
    assert_true(child > 0 && waitpid(child, &status, 0) == child && status == 0);
    assert_int_equal(read_file(s.path, &after), size);
    assert_memory_equal(after, before, size);
    close_scene(&s);
    const census c = read_all(s.path, NULL);
    if (!c.whole) fail_msg("%s", c.error);
    (void)remove(s.path);
}

/* The last line of a recording's log. */
static void last_line(const char *path, char *line, size_t bytes) {
    static rec_item item;
    char error[400];
    line[0] = '\0';
    rec_reader *r = rec_reader_open(path, error, sizeof error);
    while (r && rec_reader_next(r, &item, error, sizeof error) == 1)
        if (item.type == REC_LOG) (void)snprintf(line, bytes, "%.*s", (int)bytes - 1, item.text);
    rec_reader_close(r);
}

/* A process that ends within a recording, and is started again; and one that ends as it should. */
static void what_was_not_finished_is_kept(void **state) {
    static const char *const lines[] = {"crashes", "crashes, too", "ends", "ends, too"};
    static const char *const kept[] = {"", "crashes", "crashes, too", "crashes, too"};
    char path[64], before[80], error[300], line[64];
    (void)snprintf(path, sizeof path, "/tmp/test_recording_%d", (int)getpid());
    (void)snprintf(before, sizeof before, "%s.before", path);
    for (int n = 0; n < 4; n++) {
        const pid_t child = fork();
        if (child == 0) {
            rec *r = rec_open(path, NULL, error, sizeof error);
            if (!r) _exit(1);
            rec_log(r, SV_LOG_INFO, lines[n]);
            if (n >= 2) rec_close(r);
            _exit(0);
        }
        int status = -1;
        assert_true(child > 0 && waitpid(child, &status, 0) == child && status == 0);
        last_line(path, line, sizeof line);
        assert_string_equal(line, lines[n]);
        last_line(before, line, sizeof line);
        assert_string_equal(line, kept[n]);
    }
    (void)remove(before);
    write_file(path, (const uint8_t *)"no recording, but somebody's file", 33);
    rec *r = rec_open(path, NULL, error, sizeof error);
    assert_non_null(r);
    rec_close(r);
    assert_int_equal(access(before, F_OK), -1);
    (void)remove(path);
}

static void options_are_checked(void **state) {
    static const char *const bad[] = {"frames=0", "frames=x", "frames=3x", "voxels=maybe", "all"};
    char error[300];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_null(rec_open("/tmp/never", bad[i], error, sizeof error));
        if (!strstr(error, bad[i])) fail_msg("'%s' in '%s'", bad[i], error);
    }
    assert_null(rec_open("/nowhere/x", NULL, error, sizeof error));
    assert_non_null(strstr(error, "/nowhere/x: No such file"));
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(carriers_come_back), RIG_TEST(a_ring_keeps_the_last),
             RIG_TEST(a_ring_keeps_no_volume_of_another_activation), RIG_TEST(what_is_not_whole_is_told),
             RIG_TEST(a_fork_adds_nothing), cmocka_unit_test(what_was_not_finished_is_kept),
             cmocka_unit_test(options_are_checked))
