/* SPDX-License-Identifier: MIT */
/* host_sim verify: the files of an installation against the lists of sums that were installed with them. */
#include "report/verify.h"

#include "core/paths.h"
#include "core/sha256.h"
#include "core/system.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char prefix[SYS_PATH];
    uint32_t lists, files, wrong;
    char first[200]; /* what is wrong, first */
} sums;

static void wrong(sums *s, const char *name, const char *why) {
    if (s->wrong++ == 0) (void)snprintf(s->first, sizeof s->first, "%.120s: %.70s", name, why);
}

/* A line as sha256sum writes it: the digits, two characters, the path below the prefix. */
static void check_line(sums *s, char *line) {
    char path[SYS_PATH], found[HS_SHA256_TEXT];
    hs_error err = {0};
    line[strcspn(line, "\r\n")] = '\0';
    if (line[0] == '\0') return;
    s->files++;
    if (strlen(line) <= HS_SHA256_TEXT + 1) {
        wrong(s, line, "no sum and path");
        return;
    }
    const char *name = line + HS_SHA256_TEXT + 1;
    if (!hs_path_join(s->prefix, name, path, sizeof path, &err) || !sys_is_file(path))
        wrong(s, name, "missing");
    else if (!hs_sha256_file(path, found, &err))
        wrong(s, name, "cannot be read");
    else if (strncmp(line, found, HS_SHA256_TEXT - 1) != 0)
        wrong(s, name, "changed");
}

static void check_list(sums *s, const char *folder, const char *name) {
    char path[SYS_PATH], line[SYS_PATH + HS_SHA256_TEXT];
    hs_error err = {0};
    FILE *list = hs_path_join(folder, name, path, sizeof path, &err) ? fopen(path, "r") : NULL;
    s->lists++;
    if (!list) {
        wrong(s, name, "cannot be read");
        return;
    }
    while (fgets(line, sizeof line, list)) check_line(s, line);
    if (ferror(list)) wrong(s, name, "cannot be read to its end");
    (void)fclose(list);
}

void hs_verify_sums(hs_verify_row *row) {
    sums s = {0};
    char folder[SYS_PATH];
    DIR *all = NULL;
    if (hs_path_beside_program("..", s.prefix, sizeof s.prefix) &&
        hs_path_beside_program("../share/smartvis/sums", folder, sizeof folder))
        all = opendir(folder);
    for (const struct dirent *entry; all && (entry = readdir(all)) != NULL;)
        if (hs_path_ends(entry->d_name, ".sha256")) check_list(&s, folder, entry->d_name);
    if (all) (void)closedir(all);
    row->name = "Files";
    row->held = s.wrong > 0 ? HS_VERIFY_FAILED : s.files > 0 ? HS_VERIFY_HELD : HS_VERIFY_UNASKED;
    if (s.files == 0 && s.wrong == 0)
        (void)snprintf(row->said, sizeof row->said,
                       "no sums beside this program (share/smartvis/sums): it was not installed");
    else
        (void)snprintf(row->said, sizeof row->said, "%u of %u files are what was installed, by %u list%s%s%s",
                       s.files > s.wrong ? s.files - s.wrong : 0, s.files, s.lists, s.lists == 1 ? "" : "s",
                       s.wrong ? "; " : "", s.first);
}
