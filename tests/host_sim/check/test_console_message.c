/* SPDX-License-Identifier: MIT */
/* Messages of the console's pages: what is right arrives as it was meant, and of what is wrong the field is
 * named. */
#include "console/console.h"
#include "support/unit.h"

/* A whole state, in parts that the tests replace. */
static const char *const parts[][2] = {
    {"type", "\"state\""},
    {"serial", "7"},
    {"source", "{\"scene\":\"D01\",\"size\":96,\"volumes\":3,\"from\":\"probe\"}"},
    {"camera", "{\"yaw\":-20.5,\"pitch\":10,\"roll\":-3,\"zoom\":2}"},
    {"views", "[\"result\",\"across\"]"},
    {"picture", "512"},
    {"draft", "128"},
    {"hurried", "true"},
    {"play", "{\"on\":true,\"speed\":12.5,\"index\":2}"},
    {"cross", "[0,0.25,1]"},
    {"thick", "2.5"},
    {"render", "{\"look\":\"lit\",\"light\":[-35,40],\"t_low\":0.16,\"t_high\":0.45,\"ghost_width\":4,"
               "\"ghost_offset\":-1,\"ghost_doubt\":2,\"exposure\":1}"},
    {"lanes", "[{\"plugin\":0,\"values\":{\"q\":0.25,\"method\":1}},{\"plugin\":1,\"values\":{}}]"},
    {"marks", "[[60,50,-0.25,5,0],[1,2,3,4.5,1]]"},
    {"box", "[1,2,3,40,50.5,60]"},
};
enum { PARTS = sizeof parts / sizeof *parts };

/* The state with one part replaced (NULL: left out) or, for a name of its own, added. */
static char *state_with(const char *name, const char *value) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *out = open_memstream(&text, &bytes);
    const char *between = "{";
    bool known = false;
    assert_non_null(out);
    for (int i = 0; i < PARTS; i++) {
        const bool it = name && strcmp(parts[i][0], name) == 0;
        known |= it;
        if (it && !value) continue;
        fprintf(out, "%s\"%s\":%s", between, parts[i][0], it ? value : parts[i][1]);
        between = ",";
    }
    if (name && !known) fprintf(out, ",\"%s\":%s", name, value);
    fprintf(out, "}");
    assert_int_equal(fclose(out), 0);
    unit_keep(free, text);
    return text;
}

static bool read_text(const char *text, hs_console_message *out, hs_error *err) {
    *err = (hs_error){0};
    return hs_console_message_read(text, strlen(text), out, err);
}

static void a_state_arrives_as_it_was_meant(void **unused) {
    hs_console_message m;
    hs_error err;
    char *text = state_with(NULL, NULL);
    assert_true(read_text(text, &m, &err));
    const hs_console_state *s = &m.state;
    assert_int_equal(m.says, HS_CONSOLE_SAYS_STATE);
    assert_int_equal(s->serial, 7);
    assert_string_equal(s->source.scene, "D01");
    assert_int_equal(s->source.size, 96);
    assert_int_equal(s->source.volumes, 3);
    assert_true(s->yaw == -20.5 && s->pitch == 10 && s->roll == -3 && s->zoom == 2);
    assert_int_equal(s->views, 1u << HS_CONSOLE_RESULT | 1u << HS_CONSOLE_ACROSS);
    assert_int_equal(s->picture, 512);
    assert_int_equal(s->draft, 128);
    assert_true(s->hurried && s->playing && s->speed == 12.5);
    assert_int_equal(s->index, 2);
    assert_true(s->cross[0] == 0 && s->cross[1] == 0.25 && s->cross[2] == 1 && s->thick == 2.5);
    assert_int_equal(s->dvr.look, HS_LOOK_LIT);
    assert_true(s->dvr.ghost_width == 4.0f && s->dvr.ghost_offset == -1.0f && s->dvr.light[0] == -35.0f);
    assert_true(s->lane[0].used && s->lane[1].used);
    assert_int_equal(s->lane[0].count, 2);
    assert_string_equal(s->lane[0].values[0].key, "q");
    assert_true(s->lane[0].values[0].value == 0.25);
    assert_int_equal(s->lane[1].plugin, 1);
    assert_int_equal(s->lane[1].count, 0);
    assert_int_equal(s->mark_count, 2);
    assert_true(s->marks[0].place[2] == -0.25 && s->marks[0].radius == 5 && s->marks[0].keep == 0);
    assert_true(s->marks[1].place[0] == 1 && s->marks[1].radius == 4.5 && s->marks[1].keep == 1);
    assert_true(s->crop.used && s->crop.low[2] == 3 && s->crop.high[1] == 50.5);
}

static void a_file_and_one_lane_are_a_state_too(void **unused) {
    hs_console_message m;
    hs_error err;
    char *text = state_with("source", "{\"folder\":1,\"path\":\"a b/c.mha\",\"from\":\"left\"}");
    assert_true(read_text(text, &m, &err));
    assert_string_equal(m.state.source.scene, "");
    assert_string_equal(m.state.source.path, "a b/c.mha");
    assert_int_equal(m.state.source.folder, 1);
    assert_int_equal(m.state.source.from, HS_FROM_LEFT);
    text = state_with("lanes", "[{\"plugin\":3,\"values\":{}}]");
    assert_true(read_text(text, &m, &err));
    assert_false(m.state.lane[1].used);
}

static void the_other_messages(void **unused) {
    hs_console_message m;
    hs_error err;
    assert_true(read_text("{\"type\":\"seen\",\"frame\":12}", &m, &err));
    assert_int_equal(m.says, HS_CONSOLE_SAYS_SEEN);
    assert_int_equal(m.seen, 12);
    assert_true(read_text("{\"type\":\"do\",\"what\":\"snapshot\",\"view\":\"truth\"}", &m, &err));
    assert_int_equal(m.says, HS_CONSOLE_SAYS_DO);
    assert_int_equal(m.deed, HS_CONSOLE_SNAPSHOT);
    assert_int_equal(m.view, HS_CONSOLE_TRUTH);
    assert_true(read_text("{\"type\":\"do\",\"what\":\"write\"}", &m, &err));
    assert_int_equal(m.deed, HS_CONSOLE_WRITE);
    assert_true(read_text(
        "{\"type\":\"do\",\"what\":\"mark\",\"view\":\"full\",\"at\":[0.25,1],\"radius\":3,\"keep\":true}",
        &m, &err));
    assert_int_equal(m.deed, HS_CONSOLE_MARK);
    assert_int_equal(m.view, HS_CONSOLE_FULL);
    assert_true(m.at[0] == 0.25 && m.at[1] == 1 && m.mark.radius == 3 && m.mark.keep == 1);
}

/* Rows without a part are whole messages. */
static const struct {
    const char *part, *value, *says;
} cases[] = {
    {NULL, "", "no JSON"},
    {NULL, "{", "no JSON"},
    {NULL, "nonsense", "no JSON"},
    {NULL, "{\"type\":\"seen\",\"frame\":1} {}", "no JSON"},
    {NULL, "{\"type\":\"seen\",\"type\":\"seen\",\"frame\":1}", "no JSON: duplicate"},
    {NULL, "{\"type\":\"seen\",\"frame\":1e999}", "no JSON"},
    {NULL, "{\"type\":\"seen\",\"frame\":\"\xff\"}", "no JSON"},
    {NULL, "[1,2]", "expected an object"},
    {NULL, "[[[[[[[[[1]]]]]]]]]", "more than 8 levels"},
    {NULL, "{\"type\":\"[[[[[[[[[\"}", "type: is '[[[[[[[[[', expected one of state, seen, do"},
    {NULL, "[\"\\\"[[[[[[[[[\"]", "expected an object"},
    {NULL, "{}", "all of it: has no field 'type'"},
    {NULL, "{\"type\":5}", "type: is not a string"},
    {NULL, "{\"type\":\"other\"}", "type: is 'other', expected one of state, seen, do"},
    {NULL, "{\"type\":\"st\\u0000ate\"}", "no JSON"},
    {NULL, "{\"type\":\"st\\u001bate\"}", "expected one of state, seen, do"},
    {NULL, "{\"type\":\"seen\"}", "seen: has no field 'frame'"},
    {NULL, "{\"type\":\"seen\",\"frame\":-1}", "frame: is -1, expected 0 .. 9007199254740991"},
    {NULL, "{\"type\":\"seen\",\"frame\":1.5}", "frame: is a number, expected a whole number"},
    {NULL, "{\"type\":\"seen\",\"frame\":1,\"more\":1}", "more: is no field of this object"},
    {NULL, "{\"type\":\"do\",\"what\":\"format\"}",
     "what: is 'format', expected one of snapshot, write, mark"},
    {NULL, "{\"type\":\"do\",\"what\":\"snapshot\"}", "do: has no field 'view'"},
    {NULL, "{\"type\":\"do\",\"what\":\"snapshot\",\"view\":\"all\"}",
     "view: is 'all', expected one of result, ful"},
    {NULL, "{\"type\":\"do\",\"what\":\"write\",\"folder\":\"/tmp\"}", "folder: is no field of this object"},
    {"serial", NULL, "state: has no field 'serial'"},
    {"serial", "9007199254740992", "serial: is 9007199254740992, expected 0 .. 9007199254740991"},
    {"extra", "1", "extra: is no field of this object"},
    {"source", "\"D01\"", "source: is a string, expected an object"},
    {"source", "{\"scene\":\"D09\",\"size\":96,\"volumes\":3,\"from\":\"probe\"}",
     "source.scene: is 'D09', expected one that is built in"},
    {"source", "{\"scene\":\"real\",\"size\":96,\"volumes\":3,\"from\":\"probe\"}",
     "source.scene: is 'real', expected one that is built in"},
    {"source", "{\"scene\":\"../D01\",\"size\":96,\"volumes\":3,\"from\":\"probe\"}",
     "source.scene: is '../D01', expected one that is built in"},
    {"source", "{\"scene\":\"./D01.json-and-more\",\"size\":96,\"volumes\":3,\"from\":\"probe\"}",
     "source.scene: has 19 bytes, expected at most 15"},
    {"source", "{\"scene\":\"D01\",\"size\":512,\"volumes\":3,\"from\":\"probe\"}",
     "source.size: is 512, expected 32 .. 256"},
    {"source", "{\"scene\":\"D01\",\"size\":96,\"volumes\":17,\"from\":\"probe\"}",
     "source.volumes: is 17, expected 1 .. 16"},
    {"source", "{\"scene\":\"D01\",\"size\":96,\"volumes\":1,\"from\":\"above\"}",
     "source.from: is 'above', expected one of probe, ante"},
    {"source", "{\"folder\":0,\"path\":\"\",\"from\":\"probe\"}", "path: is empty"},
    {"source", "{\"folder\":0,\"path\":\"a\\nb\",\"from\":\"probe\"}", "path: has a control character"},
    {"source", "{\"folder\":64,\"path\":\"a\",\"from\":\"probe\"}", "source.folder: is 64, expected 0 .. 63"},
    {"source", "{\"folder\":0,\"path\":\"a\",\"scene\":\"D01\",\"from\":\"probe\"}",
     "source.folder: is no field of this object"},
    {"camera", "{\"yaw\":400,\"pitch\":0,\"roll\":0,\"zoom\":1}", "camera.yaw: is 400, expected -360 .. 360"},
    {"camera", "{\"yaw\":0,\"pitch\":\"0\",\"roll\":0,\"zoom\":1}",
     "camera.pitch: is a string, expected a number"},
    {"camera", "{\"yaw\":0,\"pitch\":0,\"roll\":0,\"zoom\":0}", "camera.zoom: is 0, expected 0.25 .. 16"},
    {"camera", "{\"yaw\":0,\"pitch\":0,\"roll\":0}", "camera: has no field 'zoom'"},
    {"views", "[\"result\",\"result \"]", "views[1]: is 'result ', expected one of result, ful"},
    {"views", "[1]", "views[0]: is a number, expected one of result, ful"},
    {"views", "{}", "views: is an object, expected an array"},
    {"picture", "1025", "picture: is 1025, expected 16 .. 1024"},
    {"draft", "4", "draft: is 4, expected 16 .. 1024"},
    {"hurried", "1", "hurried: is a number, expected true or false"},
    {"play", "{\"on\":true,\"speed\":1000,\"index\":0}", "play.speed: is 1000, expected 0.1 .. 100"},
    {"play", "{\"on\":true,\"speed\":1,\"index\":4294967296}",
     "play.index: is 4294967296, expected 0 .. 1000000"},
    {"thick", "20.5", "thick: is 20.5, expected 0 .. 20"},
    {"cross", "[0,0]", "cross: has 2 elements, expected 3"},
    {"cross", "[0,0,2]", "cross[2]: is 2, expected 0 .. 1"},
    {"render",
     "{\"look\":\"dark\",\"light\":[0,0],\"t_low\":0.1,\"t_high\":0.4,\"ghost_width\":0,\"ghost_offset\":"
     "0,\"ghost_doubt\":2,\"exposure\":1}",
     "render.look: is 'dark', expected one of thesis, lit"},
    {"render",
     "{\"look\":\"lit\",\"light\":[0,0],\"t_low\":0.5,\"t_high\":0.4,\"ghost_width\":0,\"ghost_offset\":"
     "0,\"ghost_doubt\":2,\"exposure\":1}",
     "threshold_high is 0.4"},
    {"marks", "[[1,2,3,4]]", "marks[0]: has 4 elements, expected 5"},
    {"marks", "[[1,2,3,0,1]]", "marks[0]: has a radius of 0 mm"},
    {"marks", "[[1e9,2,3,4,1]]", "marks[0][0]: is 1000000000, expected -10000 .. 10000"},
    {"box", "[1,2,3,4,5]", "box: has 5 elements, expected 6"},
    {"box", "{}", "box: is an object, expected an array"},
    {"lanes", "[]", "lanes: has 0 elements, expected 1 .. 2"},
    {"lanes", "[1]", "lanes[0]: is a number, expected an object"},
    {"lanes", "[{\"plugin\":0}]", "lanes[0]: has no field 'values'"},
    {"lanes", "[{\"plugin\":0,\"values\":[]}]", "lanes[0].values: is no object"},
    {"lanes", "[{\"plugin\":0,\"values\":{\"q\":true}}]", "lanes[0].values.q: is no number"},
    {"lanes", "[{\"plugin\":0,\"values\":{\"Q; rm\":1}}]", "values: 'Q; rm' is no parameter's key"},
    {"lanes", "[{\"plugin\":0,\"values\":{\"\":1}}]", "values: '' is no parameter's key"},
};

static void what_is_wrong_is_named(void **unused) {
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hs_console_message m;
        hs_error err;
        const char *text = cases[i].part ? state_with(cases[i].part, cases[i].value) : cases[i].value;
        if (read_text(text, &m, &err) || !strstr(err.text, cases[i].says) ||
            !(err.code == HS_ERR_INPUT || (cases[i].part && err.code != HS_OK)))
            fail_msg("%s gave '%s', expected '%s'", text, err.text, cases[i].says);
    }
}

static void limits_of_size_hold(void **unused) {
    hs_console_message m;
    hs_error err = {0};
    char *text = unit_memory(HS_CONSOLE_MAX_MESSAGE + 2), values[HS_CONSOLE_VALUES * 12 + 64];
    memset(text, ' ', HS_CONSOLE_MAX_MESSAGE + 2);
    const int length = snprintf(text, 32, "{\"type\":\"seen\",\"frame\":1}");
    text[length] = ' ';
    assert_true(hs_console_message_read(text, HS_CONSOLE_MAX_MESSAGE, &m, &err));
    assert_false(hs_console_message_read(text, HS_CONSOLE_MAX_MESSAGE + 1, &m, &err));
    assert_non_null(strstr(err.text, "16385 bytes, expected at most 16384"));
    for (int more = 0; more < 2; more++) {
        int used = snprintf(values, sizeof values, "[{\"plugin\":0,\"values\":{");
        for (int i = 0; i < HS_CONSOLE_VALUES + more; i++)
            used += snprintf(values + used, sizeof values - (size_t)used, "%s\"p%d\":%d", i ? "," : "", i, i);
        (void)snprintf(values + used, sizeof values - (size_t)used, "}}]");
        text = state_with("lanes", values);
        assert_int_equal(read_text(text, &m, &err), !more);
        if (more) assert_non_null(strstr(err.text, "values: has more than 96 members"));
    }
    /* A message need not end with a NUL, and one that stands in it does not end it. */
    err = (hs_error){0};
    assert_true(hs_console_message_read("{\"type\":\"seen\",\"frame\":1}x", 25, &m, &err));
    assert_false(hs_console_message_read("{\"type\":\"seen\",\"frame\":1}\0x", 27, &m, &err));
}

UNIT_MAIN(NULL, NULL, a_state_arrives_as_it_was_meant, a_file_and_one_lane_are_a_state_too,
          the_other_messages, what_is_wrong_is_named, limits_of_size_hold)
