/* SPDX-License-Identifier: MIT */
/* Text from outside on its way to a terminal: what may pass, and what is shown as an escape. */
#include "core/text.h"
#include "support/unit.h"

static void what_is_visible_stays(void **state) {
    static const char *const texts[] = {"",
                                        "plain ~ text!",
                                        "\xc3\xa4\xc2\xa0\xe2\x82\xac \xf0\x9f\x98\x80",
                                        "\xef\xbf\xbd",
                                        "\xf4\x8f\xbf\xbf",
                                        "back\\slash"};
    char out[128];
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_string_equal(hs_text_escape(out, sizeof out, texts[i], 0), texts[i]);
}

static void what_controls_is_shown(void **state) {
    static const char *const cases[][2] = {
        {"\x1b[31mred\x07", "\\x1b[31mred\\x07"},
        {"a\tb\rc\x7f", "a\\x09b\\x0dc\\x7f"},
        {"\xc2\x9b"
         "31m",
         "\\xc2\\x9b31m"}, /* C1: CSI as UTF-8 */
        {"\x9b"
         "31m",
         "\\x9b31m"},               /* and as a byte */
        {"\xc0\x9b", "\\xc0\\x9b"}, /* ESC in two bytes: not the shortest form */
        {"\xe0\x80\x9b", "\\xe0\\x80\\x9b"},
        {"\xed\xa0\x80", "\\xed\\xa0\\x80"},          /* a surrogate */
        {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"}, /* beyond U+10FFFF */
        {"\xff\xfe", "\\xff\\xfe"},
        {"end \xe2\x82", "end \\xe2\\x82"}, /* cut off */
        {"\xe2\x82\x1b", "\\xe2\\x82\\x1b"}};
    char out[128];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(hs_text_escape(out, sizeof out, cases[i][0], 0), cases[i][1]);
    assert_string_equal(hs_text_escape(out, sizeof out, "one\ntwo", 0), "one\\x0atwo");
    assert_string_equal(hs_text_escape(out, sizeof out, "one\ntwo", 1), "one\ntwo");
}

/* Every length of the room: never a byte behind it, never half of anything. */
static void what_does_not_fit_is_left_out(void **state) {
    static const char text[] = "a\x1b\xe2\x82\xac";
    static const char *const want[] = {
        "", "a", "a", "a", "a", "a\\x1b", "a\\x1b", "a\\x1b", "a\\x1b\xe2\x82\xac"};
    for (size_t bytes = 1; bytes <= sizeof want / sizeof *want; bytes++) {
        char out[16];
        memset(out, '#', sizeof out);
        assert_string_equal(hs_text_escape(out, bytes, text, 0), want[bytes - 1]);
        assert_true(out[bytes] == '#');
    }
}

static void whole_lines_are_printed(void **state) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *out = open_memstream(&text, &bytes);
    hs_print(out, "%s: %-6s|%d\n", "x\x1b", "ab", 3);
    (void)fclose(out);
    assert_string_equal(text, "x\\x1b: ab    |3\n");
    free(text);
}

UNIT_MAIN(NULL, NULL, what_is_visible_stays, what_controls_is_shown, what_does_not_fit_is_left_out,
          whole_lines_are_printed)
