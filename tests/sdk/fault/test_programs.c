/* SPDX-License-Identifier: MIT */
/*
 * Programs that are kept in files (smartvis/author_programs.h): the next process compiles nothing, and what
 * is damaged, of another device or of somebody else is compiled anew and never handed to the runtime.
 */
#include "support/programs_fixture.h"

/* A process that compiles, or takes the file; either way it has the right program. */
static void builds(const char *options, bool kept, cl_uint answer, const char *why) {
    sva_built built = build(text, options);
    assert_int_equal(built.kept, kept);
    assert_int_equal(from_source, !kept);
    assert_int_equal(from_binary, kept || refused);
    assert_int_equal(answer_of(built.program), answer);
    if (why[0] ? !strstr(built.why, why) : built.why[0] != '\0')
        fail_msg("'%s' where '%s' is to be said", built.why, why);
    (void)clReleaseProgram(built.program);
}

static void compiles(void) {
    builds("-DNUMBER=40", false, 42, "");
}

static void takes(void) {
    builds("-DNUMBER=40", true, 42, "");
}

static void the_next_compiles_nothing(void **state) {
    const char *folder = begin("next");
    struct stat info;
    compiles();
    takes();
    const char *path = file_in(folder, NULL);
    const struct timespec long_ago[2] = {{1000, 0}, {1000, 0}};
    assert_int_equal(utimensat(AT_FDCWD, path, long_ago, 0), 0);
    takes();
    assert_int_equal(stat(path, &info), 0);
    assert_true(info.st_mtime > 1000); /* it is used, so others go before it */
    assert_int_equal(stat(folder, &info), 0);
    assert_int_equal(info.st_mode & ALLPERMS, S_IRWXU);
}

static void a_key_has_all_that_matters(void **state) {
    (void)begin("key");
    compiles();
    builds("-DNUMBER=41", false, 43, "");
    told_driver = "of another year";
    compiles();
    told_driver = NULL;
    told_name = "of another maker";
    compiles();
    told_name = NULL;
    sva_built built = build("kernel void answer(global uint *out) { out[0] = NUMBER + 3; }", "-DNUMBER=40");
    assert_int_equal(answer_of(built.program), 43);
    (void)clReleaseProgram(built.program);
    assert_int_equal(from_source, 1);
    takes();
    /* The same source in other parts is the same program. */
    const char *parts[] = {text, text + 9};
    const size_t bytes[] = {9, strlen(text) - 9};
    sva_program_build(context, device, 2, parts, bytes, "-DNUMBER=40", &built);
    assert_true(built.kept);
    (void)clReleaseProgram(built.program);
    builds("-DNUMBER=41", true, 43, "");
}

/* Writes `bytes` of a file anew, one of them changed, or one more than there are. */
static void damage(const char *path, const unsigned char *good, size_t bytes, size_t changed) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    for (size_t i = 0; i < bytes; i++) (void)fputc(good[i] ^ (i == changed), file);
    if (changed > bytes) (void)fputc(0, file);
    assert_int_equal(fclose(file), 0);
}

static void damaged_files(void **state) {
    const char *folder = begin("damaged");
    size_t bytes = 0;
    compiles();
    const char *path = file_in(folder, &bytes);
    unsigned char *good = unit_memory(bytes);
    FILE *file = fopen(path, "rb");
    assert_int_equal(fread(good, 1, bytes, file), bytes);
    (void)fclose(file);
    for (size_t n = 0; n <= 4; n++) {
        damage(path, good, bytes * n / 5, bytes * n / 5); /* cut */
        compiles();
        damage(path, good, bytes, (bytes - 1) * n / 4);
        compiles();
    }
    damage(path, good, bytes, bytes + 1);
    compiles();
    takes();
}

/* Every byte of a file counts, in whatever place. */
static void every_byte_is_looked_at(void **state) {
    static const char key[] = "key", data[] = "some bytes";
    const char *folder = begin("bytes");
    size_t size = 0, at = 0, bytes = 0;
    sva_kept k;
    sva_kept_open(&k, true);
    sva_kept_write(&k, key, sizeof key, data, sizeof data);
    unsigned char *all = sva_kept_read(&k, key, sizeof key, &at, &bytes);
    assert_non_null(all);
    assert_int_equal(bytes, sizeof data);
    assert_memory_equal(all + at, data, sizeof data);
    (void)file_in(folder, &size);
    assert_int_equal(size, at + bytes);
    for (size_t i = 0; i < size; i++)
        for (unsigned bit = 1; bit < 256; bit *= 2) {
            all[i] ^= (unsigned char)bit;
            if (sva_kept_find(all, size, key, sizeof key, &bytes)) fail_msg("bit %u of byte %zu", bit, i);
            all[i] ^= (unsigned char)bit;
        }
    for (size_t i = 0; i < size; i++) assert_int_equal(sva_kept_find(all, i, key, sizeof key, &bytes), 0);
    assert_int_equal(sva_kept_find(all, size, key, sizeof key - 1, &bytes), 0);
    assert_int_equal(sva_kept_find(all, size, key, sizeof key, &bytes), at);
    free(all);
    sva_kept_close(&k);
}

static void what_others_may_write(void **state) {
    const char *folder = begin("others");
    compiles();
    const char *path = file_in(folder, NULL);
    static const mode_t by_others[] = {S_IWGRP, S_IWOTH};
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(chmod(path, S_IRUSR | S_IWUSR | by_others[i]), 0);
        compiles(); /* and it is the user's alone again */
        takes();
        assert_int_equal(chmod(folder, S_IRWXU | by_others[i]), 0);
        builds("-DNUMBER=40", false, 42, "can be written by others");
        assert_int_equal(chmod(folder, S_IRWXU), 0);
    }
    if (geteuid() == 0) {
        assert_int_equal(chown(path, 65534, 65534), 0);
        compiles();
        takes();
        assert_int_equal(chown(folder, 65534, 65534), 0);
        builds("-DNUMBER=40", false, 42, "is another user's");
        assert_int_equal(chown(folder, 0, 0), 0);
    }
    takes();
}

static void what_is_no_file(void **state) {
    const char *folder = begin("no_file");
    compiles();
    const char *path = file_in(folder, NULL), *elsewhere = files_path("elsewhere");
    assert_int_equal(rename(path, elsewhere), 0);
    assert_int_equal(symlink(elsewhere, path), 0);
    compiles();
    takes();
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkfifo(path, 0600), 0);
    compiles();
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkdir(path, 0700), 0);
    builds("-DNUMBER=40", false, 42, "cannot be written: Is a directory");
    assert_int_equal(rmdir(path), 0);
    compiles();
    (void)file_in(folder, NULL); /* nothing else was left */
}

static volatile sig_atomic_t signals;

static void count_signal(int number) {
    signals++;
}

/* Beyond this limit a signal would come, which ends a process. */
static void nothing_can_be_written(void **state) {
    const char *folder = begin("limit");
    struct rlimit was, small;
    sva_kept k;
    sva_kept_open(&k, true);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &was), 0);
    small = was;
    small.rlim_cur = 100;
    void (*before)(int) = signal(SIGXFSZ, count_signal);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    sva_kept_write(&k, "key", 3, text, sizeof text);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &was), 0);
    (void)signal(SIGXFSZ, before);
    assert_int_equal(signals, 0);
    assert_non_null(strstr(k.why, "cannot be written: File too large"));
    sva_kept_close(&k);
    assert_int_equal(rmdir(folder), 0); /* nothing is in it */
    files_write("a_file", "", NULL, 0);
    (void)begin("a_file/in_it");
    builds("-DNUMBER=40", false, 42, "cannot be opened: Not a directory");
}

static void the_runtime_refuses(void **state) {
    (void)begin("refused");
    compiles();
    refused = true;
    compiles();
    refused = false;
    takes();
    sva_built built;
    const char *wrong = "no kernel";
    const size_t bytes = strlen(wrong);
    for (int i = 0; i < 2; i++) { /* and what does not build is not kept */
        from_source = 0;
        sva_program_build(context, device, 1, &wrong, &bytes, "", &built);
        assert_int_equal(built.code, CL_BUILD_PROGRAM_FAILURE);
        assert_non_null(built.program);
        assert_string_equal(built.why, "");
        assert_int_equal(from_source, 1);
        (void)clReleaseProgram(built.program);
    }
}

static void whose_programs_are_kept(void **state) {
    const char *home = files_path("home");
    const char *names[] = {"", "/smartvis", "/smartvis/kernels"};
    struct stat info;
    (void)begin("unused");
    assert_int_equal(unsetenv("SMARTVIS_KERNEL_CACHE"), 0);
    assert_int_equal(setenv("XDG_CACHE_HOME", home, 1), 0);
    told_name = "Portable Computing Language"; /* it keeps them itself */
    compiles();
    compiles();
    assert_int_equal(stat(home, &info), -1);
    told_name = "Intel(R) OpenCL";
    compiles();
    takes();
    assert_int_equal(setenv("SMARTVIS_KERNEL_CACHE", "", 1), 0);
    compiles();
    assert_int_equal(unsetenv("SMARTVIS_KERNEL_CACHE"), 0);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(stat(unit_text("%s%s", home, names[i]), &info), 0);
        assert_int_equal(info.st_mode & ALLPERMS, S_IRWXU);
    }
    sva_kept_empty();
    for (int i = 2; i >= 0; i--) assert_int_equal(rmdir(unit_text("%s%s", home, names[i])), 0);
}

/* A file of 60 MiB of which the disk has nothing. */
static const char *large(const char *folder, const char *name, time_t used) {
    const char *path = unit_text("%s/%s", folder, name);
    const struct timespec times[2] = {{used, 0}, {used, 0}};
    const int file = open(path, O_WRONLY | O_CREAT, 0600);
    assert_int_equal(ftruncate(file, (off_t)60 << 20), 0);
    assert_int_equal(futimens(file, times), 0);
    assert_int_equal(close(file), 0);
    return path;
}

static void the_oldest_goes(void **state) {
    const char *folder = begin("sweep");
    compiles();
    const char *const mine = unit_text("%s/notes", folder);
    /* The clock was set back, so what is new is the oldest. */
    const time_t later = time(NULL) + 100000;
    const char *middle = large(folder, "00000000000000a1.kernels", later + 2000);
    const char *first = large(folder, "00000000000000a2.kernels.1.0x1", later + 1000);
    const char *last = large(folder, "00000000000000a3.kernels", later + 3000);
    (void)large(folder, "notes", 1);
    const char *no_file = unit_text("%s/00000000000000a0.kernels", folder);
    assert_int_equal(mkdir(no_file, 0700), 0); /* older than those, and not to be removed */
    builds("-DNUMBER=41", false, 43, "");
    assert_int_equal(access(first, F_OK), -1);
    assert_int_equal(access(middle, F_OK) + access(last, F_OK), 0);
    assert_int_equal(access(mine, F_OK), 0);
    builds("-DNUMBER=41", true, 43, "");
    sva_kept_empty();
    assert_int_equal(access(middle, F_OK), -1);
    compiles();
    assert_int_equal(unlink(mine) + rmdir(no_file), 0);
}

UNIT_MAIN(setup, teardown, the_next_compiles_nothing, a_key_has_all_that_matters, damaged_files,
          every_byte_is_looked_at, what_others_may_write, what_is_no_file, nothing_can_be_written,
          the_runtime_refuses, whose_programs_are_kept, the_oldest_goes)
