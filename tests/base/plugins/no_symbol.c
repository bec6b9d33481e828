/* SPDX-License-Identifier: MIT */
/* A library that loads well and is no plugin. */
int no_plugin_here(void);
int no_plugin_here(void) {
    return 42;
}
