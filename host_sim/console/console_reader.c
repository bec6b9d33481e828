/* SPDX-License-Identifier: MIT */
/* What the console asks whoever has started it. */
#include "console/served_files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum { ANSWER = 1 << 16, QUESTION = 1 << 13 };

bool hs_console_check_reader(uint32_t reader, hs_error *err) {
    int type = 0;
    socklen_t bytes = sizeof type;
    if (getsockopt((int)reader, SOL_SOCKET, SO_TYPE, &type, &bytes) != 0 || type != SOCK_SEQPACKET ||
        fcntl((int)reader, F_SETFD, FD_CLOEXEC) != 0)
        return hs_fail(err, HS_ERR_USAGE, "--reader %u: is no socket of who reads volumes", reader);
    return true;
}

/* One message; "": nobody is there any more. */
static void hear(int reader, char *answer) {
    ssize_t came;
    do {
        came = recv(reader, answer, ANSWER - 1, 0);
    } while (came < 0 && errno == EINTR);
    answer[came > 0 ? came : 0] = '\0';
}

bool hs_console_ask(uint32_t reader, const char *what, const char *path, const char *of, char **answer,
                    hs_error *err) {
    char question[QUESTION];
    const int length = snprintf(question, sizeof question, "%s\n%s\n%s", what, path, of);
    char *heard = hs_memory(1, ANSWER, "answer", err);
    *answer = NULL;
    if (!heard) return false;
    if (length > 0 && length < QUESTION &&
        send((int)reader, question, (size_t)length, MSG_NOSIGNAL) == (ssize_t)length)
        hear((int)reader, heard);
    const bool ok = heard[0] == '+';
    if (ok)
        *answer = strdup(heard + 1);
    else
        (void)hs_fail(err, HS_ERR_INPUT, "%s", heard[0] ? heard + 1 : "Who reads other formats has gone.");
    free(heard);
    return ok && (*answer || hs_fail(err, HS_ERR_MEMORY, "answer: no memory"));
}
