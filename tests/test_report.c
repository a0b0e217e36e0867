/* The report: the table on the terminal and the HTML page. `test_report --write FOLDER` only writes
 * a sample there, for a look or for tests/report/check.sh. */
#include "framework/base/file.h"
#include "framework/compare/prediction.h"
#include "framework/report/report.h"
#include "framework/table/page.h"
#include "framework/workload/workload.h"
#include "tests/fixture.h"
#include "tests/record_fixture.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

extern const char bb_text_report_html[];

static char *table_of(bb_results *results)
{
    static char *text; /* static: gcc 12 takes the stream's buffer for the variable's address */
    static size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_int_equal(bb_predictions_record(results), BB_OK);
    assert_int_equal(bb_report_table(results, out), BB_OK);
    fclose(out);
    return text;
}

static size_t count_of(const char *text, const char *word)
{
    size_t count = 0;
    for (const char *at = strstr(text, word); at != NULL; at = strstr(at + 1, word))
        count++;
    return count;
}

static bool line_has(const char *line, const char *word)
{
    const char *found = strstr(line, word), *end = strchr(line, '\n');
    return found != NULL && found < end;
}

/* Whether a line has rays missed, false and of wrong t: "3/0/12". */
static bool line_has_classes(const char *line)
{
    int length = 0;
    for (; *line != '\n' && length == 0; line++)
        if (*line >= '0' && *line <= '9')
            sscanf(line, "%*u/%*u/%*u%n", &length);
    return length > 0;
}

/* Lines that begin with `start` and have `word`, or, if that is NULL, classes. */
static size_t count_rows(const char *text, const char *start, const char *word)
{
    size_t count = 0;
    for (const char *line = text; line != NULL; line = strchr(line, '\n')) {
        line += *line == '\n';
        count += strncmp(line, start, strlen(start)) == 0 &&
                 (word != NULL ? line_has(line, word) : line_has_classes(line));
    }
    return count;
}

static void table_marks_wrong_cells(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    char *text = table_of(results);
    /* one cell above the limit; its rate stands in the same line */
    assert_int_equal(count_of(text, "WRONG"), 1);
    const char *mark = strstr(text, "2.86 WRONG OVERFLOW");
    assert_non_null(mark);
    assert_non_null(strstr(text, "0/0/3"));
    free(text);
    bb_results_destroy(results);
}

static void table_shows_every_row(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    char *text = table_of(results);
    for (size_t i = 0; i < SAMPLE_SCENES; i++)
        assert_non_null(strstr(text, sample_scenes[i].name));
    /* per scene: one line among the builds, and per ray set 3 of our cells or 1 of the reference */
    size_t sets = sizeof sample_ray_sets / sizeof sample_ray_sets[0];
    static const char reference[] = "embree-native:quality=medium,mode=fast ";
    assert_int_equal(count_rows(text, "lbvh:bits=63 ", "iB "), SAMPLE_SCENES);
    assert_int_equal(count_rows(text, "lbvh:bits=63 ", NULL), SAMPLE_SCENES * 3 * sets);
    assert_int_equal(count_rows(text, reference, "iB "), SAMPLE_SCENES);
    assert_int_equal(count_rows(text, reference, NULL), SAMPLE_SCENES * sets);
    assert_int_equal(count_rows(text, "null ", "refused  brute force"), SAMPLE_SCENES);
    assert_non_null(strstr(text, "stack * / moller")); /* on the builder's own tree */
    assert_null(strstr(text, "leaf=4 *"));
    free(text);
    bb_results_destroy(results);
}

static void table_hides_no_step(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    char *text = table_of(results);
    assert_non_null(strstr(text, "\noracle     1,062        -\n"));
    assert_non_null(strstr(text, "\nbuild          -    2,500\n"));
    assert_non_null(strstr(text, "\ntrace          -   21,000\n"));
    assert_non_null(strstr(text, "\nother          -      669\n"));
    assert_non_null(strstr(text, "\ntotal          -   31,000\n"));
    free(text);

    /* merged with one without a total: the steps and their sum */
    assert_int_equal(bb_results_set_total(results, NAN, NAN, NAN), BB_OK);
    text = table_of(results);
    assert_null(strstr(text, "\nother "));
    assert_null(strstr(text, "\ntotal "));
    assert_non_null(strstr(text, "\nall steps together: 6,830 ms\n"));
    free(text);
    bb_results_destroy(results);
}

static void tables_show_what_trees_cost(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    char *text = table_of(results);
    static const char *const stages[][2] = {
        {"embree:quality=high  presplit ", " 1.50           -       1,048,576      3,145,728\n"},
        {"embree:quality=high  embree ", " 2.50        59.0       2,097,152      4,194,304\n"},
        {"embree:quality=high  map ", " 3.50           -               -              -\n"},
        {"embree:quality=high  rotate ", " 4.50        57.0       4,194,304      6,291,456\n"}};
    for (size_t i = 0; i < 4; i++) {
        const char *row = strstr(text, stages[i][0]), *figures = strstr(text, stages[i][1]);
        assert_non_null(row);
        assert_true(figures > row && strchr(row, '\n') + 1 == figures + strlen(stages[i][1]));
    }
    assert_true(line_has(strstr(text, "First ray"), "First ray  EPO~"));
    assert_int_equal(count_rows(text, "lbvh:bits=63 ", "pair:leaf=4 "), SAMPLE_SCENES);
    assert_true(line_has(strstr(text, "Box tests"), "Prim. tests  Work"));
    const char *fit = strstr(text, "(1 - alpha) SAH + alpha EPO");
    assert_non_null(fit);
    assert_true(line_has(strstr(fit, "\nprimary") + 1, "  60 ")); /* 5 trees, 2 views, 2 kernels */
    free(text);
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_int_equal(bb_report_csv(results, out), BB_OK);
    fclose(out);
    assert_true(line_has(text, ",work_per_ray,") && line_has(text, ",layout_ms,first_ray_ms,") &&
                line_has(text, ",tree_epo_quick"));
    free(text);
    out = open_memstream(&text, &size);
    assert_int_equal(bb_report_markdown(results, out), BB_OK);
    fclose(out);
    assert_non_null(strstr(text, "| SAH /best | EPO /best | work /best |"));
    assert_null(strstr(text, "above 3 times"));
    free(text);
    /* ten times what `sah` has */
    bb_table_set_number(results->table, entry_at(results, BB_BUILDS, 4)->row,
                        bb_metric_column(&bb_metric_sah, false), 612);
    out = open_memstream(&text, &size);
    assert_int_equal(bb_report_markdown(results, out), BB_OK);
    assert_int_equal(bb_report_verdict(results, out), BB_OK);
    fclose(out);
    assert_int_equal(count_of(text, "lbvh:bits=63 on coffee has 10 times that of sah"), 2);
    free(text);
    bb_results_destroy(results);
}

static void table_names_what_was_skipped(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    char *text = table_of(results);
    assert_non_null(
        strstr(text, "\ncoffee                           edges     front  the mesh is not closed"));
    assert_non_null(strstr(text, "state=settled  edges            spheres have no edges\n"));
    free(text);
    bb_results_destroy(results);
}

/* Brute force traces the first rays of a set only: the set's size heads the rows, the row says
 * so. */
static void table_notes_partly_traced_sets(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_put_number(entry_at(results, BB_TRACES, 0), BB_F_TRACE_COUNT, 1234);
    char *text = table_of(results);
    assert_non_null(strstr(text, "primary, view front: 262,144 rays, closest hit\n"));
    assert_int_equal(count_of(text, "of the first 1,234 rays\n"), 1);
    assert_int_equal(count_of(text, "of the first"), 1);
    free(text);
    bb_results_destroy(results);
}

/* A query that this version does not know is printed by its name. */
static void table_names_the_query(void **state)
{
    (void)state;
    static const struct {
        const char *query, *words;
    } cases[] = {{"closest", ": 262,144 rays, closest hit\n"},
                 {"any", ": 262,144 rays, any hit\n"},
                 {"interval", ": 262,144 rays, first and last hit\n"},
                 {"nearest-two", ": 262,144 rays, nearest-two\n"},
                 {"", ": 262,144 rays\n"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_results *results = sample_results(NULL);
        bb_put_text(entry_at(results, BB_TRACES, 0), BB_F_TRACE_QUERY, cases[i].query);
        char *text = table_of(results);
        const char *heading = strstr(text, "\nprimary, view front");
        if (heading == NULL || !line_has(heading + 1, cases[i].words))
            fail_msg("query '%s': %.60s", cases[i].query, heading != NULL ? heading + 1 : text);
        free(text);
        bb_results_destroy(results);
    }
}

/* The line of the table after the first `heading` that begins with `start`. */
static const char *line_after(const char *text, const char *heading, const char *start)
{
    const char *at = strstr(text, heading);
    at = at != NULL ? strstr(at, start) : NULL;
    assert_non_null(at);
    return at + 1;
}

/* The sample's scenes have 6, 3 and 1 rounds that count: of one there are no brackets. */
static void table_calls_a_range_a_range(void **state)
{
    (void)state;
    static const struct {
        const char *scene;
        bool brackets, range;
    } cases[] = {
        {"\ncoffee:", true, false}, {"\ninterior:", true, true}, {"\nspheres:", false, false}};
    static const char *const columns[] = {"Build ms", "Mrays/s"};
    bb_results *results = sample_results(NULL);
    char *text = table_of(results);
    for (int i = 0; i < 3; i++) {
        const char *scene = strstr(text, cases[i].scene);
        for (int k = 0; k < 2; k++) {
            const char *line = line_after(scene, columns[k], "\nsah ");
            if (line_has(line, "[") != cases[i].brackets ||
                line_has(line, "] range ") != cases[i].range)
                fail_msg("%s, %s: %.120s", cases[i].scene, columns[k], line);
        }
    }
    assert_int_equal(count_of(text, "- [a, b]: 95 % interval of the median"), 1);
    assert_non_null(strstr(text, "range: the lowest and the highest of too\n  few rounds"));
    free(text);
    bb_results_destroy(results);
}

/* Among intervals, as in a report of several runs, a range says what it is. */
static void table_tells_a_range_among_intervals(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    const bb_samples few = {4, {9, 5, 6, 7}};
    bb_put_rounds(entry_at(results, BB_BUILDS, 0), BB_F_BUILD_MS, &few);
    bb_put_rounds(entry_at(results, BB_TRACES, 0), BB_F_TRACE_MS, &few);
    char *text = table_of(results);
    assert_true(line_has(line_after(text, "Build ms", "\nsah "), "] range "));
    assert_false(line_has(line_after(text, "Build ms", "\nlbvh"), "range"));
    assert_true(line_has(line_after(text, "Mrays/s", "\nsah "), "] range "));
    assert_false(line_has(line_after(text, "Mrays/s", "\nlbvh"), "range"));
    free(text);
    bb_results_destroy(results);
}

/* Rays that were made by hand, of one of the scenes. */
static void table_marks_rays_as_given(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    char *text = table_of(results);
    assert_int_equal(count_of(text, "\ndiffuse (rays as given): 1,048,576 rays"), 1);
    assert_int_equal(count_of(text, "\ndiffuse: 1,048,576 rays"), SAMPLE_SCENES - 1);
    assert_int_equal(count_of(text, "as given"), 1);
    free(text);
    bb_results_destroy(results);
}

/* The ratio is to the fastest embree-native row of the same rays. */
static void table_ratio_is_to_the_fastest_reference(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    for (bb_entry *trace = entry_at(results, BB_TRACES, 0); trace != NULL; trace = trace->next) {
        const char *builder = bb_get_text(trace, BB_F_TRACE_BUILDER);
        double rate = strstr(builder, "fast") != NULL        ? 8
                      : strstr(builder, "native") != NULL    ? 5
                      : strcmp(builder, "lbvh:bits=30") == 0 ? 2
                                                             : 1;
        bb_put_number(trace, BB_F_TRACE_RATE_GIVEN, rate);
    }
    char *text = table_of(results);
    const char *line = strstr(strstr(text, "/Embree"), "\nlbvh:bits=30");
    assert_non_null(line);
    const char *bracket = strchr(line, ']');
    assert_non_null(bracket);
    char *end;
    assert_true(strtod(bracket + 1, &end) == 0); /* wrong ones */
    double ratio = strtod(end, NULL);
    assert_true(ratio == 0.25);
    free(text);
    bb_results_destroy(results);
}

static void table_copes_with_nothing(void **state)
{
    (void)state;
    bb_results *results = NULL;
    bb_context context = {NULL, 1, NULL};
    assert_int_equal(bb_results_create(&context, &results), BB_OK);
    char *text = table_of(results);
    assert_non_null(strstr(text, "bvhbench"));
    free(text);
    bb_results_destroy(results);
}

static void table_keeps_the_terminal_safe(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    bb_put_text(entry_at(results, BB_BUILDS, 0), BB_F_BUILD_ABOUT, "s\x1b[");
    assert_int_equal(bb_results_add_skipped(results, "coffee", "\x1b[2J", "", "\x1b[3J"), BB_OK);
    char *text = table_of(results);
    assert_null(strchr(text, '\x1b'));
    free(text);
    bb_results_destroy(results);
}

static char *page_of(bb_results *results, const char *folder)
{
    char path[600];
    snprintf(path, sizeof path, "%s/report.html", folder);
    char *page = NULL;
    size_t size;
    assert_int_equal(bb_report_html(results, folder, path), BB_OK);
    assert_int_equal(bb_file_read(path, 1 << 28, "page", &page, &size), BB_OK);
    assert_int_equal(size, strlen(page));
    return page;
}

/* What stands in a file does not steer the terminal (framework/base/steering.h). Letters stay. */
static void texts_do_not_steer_the_terminal(void **state)
{
    (void)state;
    static const char text[] = "a\x1b[2J\nb\xc2\x9bm \xe2\x80\xae z \xe2\x81\xa6 \xc3\xa9 "
                               "\xe2\x82\xac\xc2";
    char *printed = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&printed, &size);
    assert_non_null(out);
    bb_page *page;
    assert_int_equal(bb_page_create("steering", &page), BB_OK);
    bb_page_say(page, "%s", text);
    assert_int_equal(bb_page_end(page, bb_page_print, out), BB_OK);
    fclose(out);
    assert_string_equal(printed, "a?[2J b?m ? z ? \xc3\xa9 \xe2\x82\xac%C2\n\n");
    free(printed);
}

static void page_loads_nothing(void **state)
{
    (void)state;
    const char *folder = sample_folder("page_loads_nothing");
    bb_results *results = sample_results(folder);
    char *page = page_of(results, folder);
    assert_null(strstr(page, "@BB_"));
    static const char *const loads[] = {"src=\"http",  "src='http", "href=\"http",    "href='http",
                                        "src=\"//",    "href=\"//", "url(http",       "@import",
                                        "<script src", "fetch(",    "XMLHttpRequest", "<iframe"};
    for (size_t i = 0; i < sizeof loads / sizeof loads[0]; i++)
        if (strstr(page, loads[i]) != NULL)
            fail_msg("the page has %s", loads[i]);
    assert_non_null(strstr(page, "default-src 'none'"));
    free(page);
    bb_results_destroy(results);
}

/* Markup in names and reasons stays text: no script is ended but those of the template. */
/* They stand under the figures of every run: none speaks of rays that a run may not have. */
static void captions_hold_for_every_run(void **state)
{
    (void)state;
    size_t captions = 0;
    for (const char *at = bb_text_report_html; (at = strstr(at, "<figcaption")) != NULL; at++) {
        const char *end = strstr(at, "</figcaption>");
        assert_non_null(end);
        char *caption = strndup(at, (size_t)(end - at));
        assert_null(strstr(caption, "edge"));
        for (const bb_workload *const *w = bb_workloads; *w != NULL; w++)
            if (strstr(caption, (*w)->name) != NULL)
                fail_msg("%s rays in %s", (*w)->name, caption);
        free(caption);
        captions++;
    }
    assert_true(captions >= 8);
}

static void page_escapes_data(void **state)
{
    (void)state;
    const char *folder = sample_folder("page_escapes_data");
    bb_results *results = sample_results(folder);
    char *page = page_of(results, folder);
    assert_int_equal(count_of(page, "</script"), 9);
    assert_non_null(strstr(page, "\\u003c/script>\\u003cb>"));

    /* and what stands in the page is the document, digit for digit */
    char *start = strstr(page, "id=\"data\">");
    assert_non_null(start);
    cJSON *read = cJSON_Parse(start + strlen("id=\"data\">"));
    assert_non_null(read);
    assert_true(cJSON_Compare(read, document_of(results), 1));
    cJSON_Delete(read);
    free(page);
    bb_results_destroy(results);
}

static void page_embeds_pictures(void **state)
{
    (void)state;
    const char *folder = sample_folder("page_embeds_pictures");
    bb_results *results = sample_results(folder);
    char *page = page_of(results, folder);
    char *start = strstr(page, "id=\"picture-data\">");
    cJSON *pictures = cJSON_Parse(start + strlen("id=\"picture-data\">"));
    assert_int_equal(cJSON_GetArraySize(pictures), 2);
    cJSON *src = cJSON_GetObjectItem(cJSON_GetArrayItem(pictures, 0), "src");
    assert_non_null(src);
    /* the signature of a PNG in base64 */
    assert_int_equal(strncmp(src->valuestring, "data:image/png;base64,iVBORw0KGgo", 33), 0);
    assert_int_equal(strlen(src->valuestring + 22) % 4, 0);
    assert_null(cJSON_GetObjectItem(cJSON_GetArrayItem(pictures, 1), "src"));
    assert_non_null(cJSON_GetObjectItem(cJSON_GetArrayItem(pictures, 1), "missing"));
    cJSON_Delete(pictures);
    free(page);
    bb_results_destroy(results);
}

static void page_takes_in_no_other_files(void **state)
{
    (void)state;
    const char *folder = sample_folder("page_takes_in_no_other_files");
    bb_results *results = sample_results(folder);
    char path[600], inside[600], below[700];
    snprintf(path, sizeof path, "%s/heat.png", folder);
    snprintf(inside, sizeof inside, "%s/inside", folder);
    assert_true(mkdir(inside, 0777) == 0 || errno == EEXIST);
    snprintf(below, sizeof below, "%s/link.png", inside);
    unlink(below);
    assert_int_equal(symlink(path, below), 0);
    assert_int_equal(bb_file_write(strcat(inside, "/text.png"), "text", 4, "text"), BB_OK);
    *strrchr(inside, '/') = '\0';
    static const char *const outside[] = {"/etc/passwd", "../heat.png", "link.png"};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++)
        assert_int_equal(bb_results_add_picture(results, "coffee", "", "", outside[i]), BB_OK);
    assert_int_equal(bb_results_add_picture(results, "coffee", "", "", path), BB_OK);
    assert_int_equal(bb_results_add_picture(results, "coffee", "", "", "text.png"), BB_OK);
    char *page = page_of(results, inside);
    assert_int_equal(count_of(page, "the file is not in the folder of the results"), 4);
    assert_int_equal(count_of(page, "the file is no PNG"), 1);
    assert_null(strstr(page, "data:image/png"));
    free(page);
    page = page_of(results, folder);
    assert_int_equal(count_of(page, "data:image/png;base64,iVBOR"), 1);
    free(page);
    bb_results_destroy(results);
}

static void page_says_where_it_cannot_write(void **state)
{
    (void)state;
    bb_results *results = sample_results(NULL);
    assert_int_equal(bb_report_html(results, ".", "/nonexistent/folder/report.html"), BB_INVALID);
    assert_non_null(strstr(bb_message(), "/nonexistent/folder/report.html"));
    assert_int_equal(bb_report_html(results, ".", "/dev/null"), BB_INVALID);
    bb_results_destroy(results);
}

/* ---- the command ---- */

/* Exit status of `bvhbench ARGUMENTS`, its standard error in `message`. */
static int command(const char *arguments, char *message, size_t capacity)
{
    char line[2048], path[600];
    snprintf(path, sizeof path, "%s/stderr", sample_folder("command"));
    snprintf(line, sizeof line, "'%s' %s >/dev/null 2>'%s'", BB_TEST_PROGRAM, arguments, path);
    int status = system(line);
    char *text = NULL;
    size_t size;
    assert_int_equal(bb_file_read(path, 1 << 20, "stderr", &text, &size), BB_OK);
    snprintf(message, capacity, "%s", text);
    free(text);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void command_makes_a_report(void **state)
{
    (void)state;
    const char *folder = sample_folder("command");
    char path[600], arguments[1800], message[1024];
    bb_results *results = sample_results(folder);
    snprintf(path, sizeof path, "%s/results.json", folder);
    assert_int_equal(bb_results_write(results, path), BB_OK);
    snprintf(path, sizeof path, "%s/again.json", folder);
    assert_int_equal(bb_results_write(results, path), BB_OK);
    snprintf(path, sizeof path, "%s/report.html", folder);
    unlink(path);
    snprintf(arguments, sizeof arguments, "report '%s' --charts no", folder);
    assert_int_equal(command(arguments, message, sizeof message), 0);
    assert_int_equal(access(path, R_OK), 0);
    /* two files, two runs, and the pictures are found though `--out` lies elsewhere */
    snprintf(arguments, sizeof arguments,
             "report '%s' '%s/again.json' --out '%s/two.html' --charts no", folder, folder, folder);
    assert_int_equal(command(arguments, message, sizeof message), 0);
    char *page = NULL;
    size_t size;
    snprintf(path, sizeof path, "%s/two.html", folder);
    assert_int_equal(bb_file_read(path, 1 << 28, "page", &page, &size), BB_OK);
    assert_non_null(strstr(page, "\"merged\":[{"));
    assert_int_equal(count_of(page, "data:image/png;base64,iVBOR"), 2);
    free(page);
    bb_results_destroy(results);
    /* one file by two names would count twice */
    snprintf(arguments, sizeof arguments, "report '%s/again.json' '%s' '%s/../%s/again.json'",
             folder, folder, folder, strrchr(folder, '/') + 1);
    assert_int_equal(command(arguments, message, sizeof message), 2);
    assert_non_null(strstr(message, "again.json is given twice"));
    assert_int_equal(count_of(message, "\n"), 1);
}

/* Charts where gnuplot is; without it a page all the same and a line that says so, unless that was
 * asked for. */
static void command_draws_charts(void **state)
{
    (void)state;
    const char *folder = sample_folder("command");
    char path[600], arguments[1800], message[1024];
    bb_results *results = sample_results(folder);
    snprintf(path, sizeof path, "%s/results.json", folder);
    assert_int_equal(bb_results_write(results, path), BB_OK);
    bb_results_destroy(results);
    snprintf(path, sizeof path, "%s/report-charts/coffee_primary_accuracy.svg", folder);
    unlink(path);

    snprintf(arguments, sizeof arguments, "report '%s' --charts no", folder);
    assert_int_equal(command(arguments, message, sizeof message), 0);
    assert_string_equal(message, "");
    assert_int_equal(access(path, F_OK), -1);

    char *search = strdup(getenv("PATH"));
    setenv("PATH", "/nonexistent:", 1);
    snprintf(arguments, sizeof arguments, "report '%s'", folder);
    assert_int_equal(command(arguments, message, sizeof message), 0);
    assert_non_null(strstr(message, "gnuplot-nox"));
    assert_int_equal(count_of(message, "\n"), 1);
    snprintf(arguments, sizeof arguments, "report '%s' --charts yes", folder);
    assert_int_equal(command(arguments, message, sizeof message), 2);
    assert_non_null(strstr(message, "gnuplot-nox"));
    assert_int_equal(access(path, F_OK), -1);
    setenv("PATH", search, 1);
    free(search);

    if (!bb_report_can_draw())
        skip(); /* gnuplot is not installed */
    assert_int_equal(command(arguments, message, sizeof message), 0);
    assert_string_equal(message, "");
    assert_int_equal(access(path, F_OK), 0);
}

static void command_refuses_in_one_line(void **state)
{
    (void)state;
    static const char *const bad[] = {"report",
                                      "report /nonexistent",
                                      "report /dev/null",
                                      "report --out x.html",
                                      "report --nonsense x",
                                      "report . --charts maybe",
                                      "report /etc/passwd"};
    char message[1024];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        int status = command(bad[i], message, sizeof message);
        if (status != 2 || count_of(message, "\n") != 1)
            fail_msg("bvhbench %s: status %d, message '%s'", bad[i], status, message);
    }
}

static int write_sample(const char *folder)
{
    char path[600];
    bb_results *results = sample_results(folder);
    snprintf(path, sizeof path, "%s/results.json", folder);
    bb_status status = bb_results_write(results, path);
    snprintf(path, sizeof path, "%s/report.html", folder);
    if (status == BB_OK)
        status = bb_report_html(results, folder, path);
    if (status == BB_OK)
        status = bb_report_table(results, stdout);
    uint32_t charts;
    snprintf(path, sizeof path, "%s/report-charts", folder);
    if (status == BB_OK && bb_report_can_draw())
        status = bb_report_charts(results, path, &charts);
    if (status != BB_OK)
        fprintf(stderr, "%s\n", bb_message());
    bb_results_destroy(results);
    return status == BB_OK ? 0 : 1;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0)
        return write_sample(argv[2]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_marks_wrong_cells),
        cmocka_unit_test(table_shows_every_row),
        cmocka_unit_test(table_hides_no_step),
        cmocka_unit_test(tables_show_what_trees_cost),
        cmocka_unit_test(table_names_what_was_skipped),
        cmocka_unit_test(table_notes_partly_traced_sets),
        cmocka_unit_test(table_names_the_query),
        cmocka_unit_test(table_calls_a_range_a_range),
        cmocka_unit_test(table_tells_a_range_among_intervals),
        cmocka_unit_test(table_marks_rays_as_given),
        cmocka_unit_test(table_ratio_is_to_the_fastest_reference),
        cmocka_unit_test(table_copes_with_nothing),
        cmocka_unit_test(table_keeps_the_terminal_safe),
        cmocka_unit_test(texts_do_not_steer_the_terminal),
        cmocka_unit_test(page_loads_nothing),
        cmocka_unit_test(captions_hold_for_every_run),
        cmocka_unit_test(page_escapes_data),
        cmocka_unit_test(page_embeds_pictures),
        cmocka_unit_test(page_takes_in_no_other_files),
        cmocka_unit_test(page_says_where_it_cannot_write),
        cmocka_unit_test(command_makes_a_report),
        cmocka_unit_test(command_draws_charts),
        cmocka_unit_test(command_refuses_in_one_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
