/* `bvhbench reproduce all` from outside: a page of all papers; what was measured is kept. */
#include "tests/program_fixture.h"

#include <string.h>
#include <sys/stat.h>

#define ALL "reproduce all --quick --charts no --out all"

static const char *const papers[] = {"dynamic", "emc", "loose-octree", "olbvh", "simt", "volume"};
enum { PAPERS = sizeof papers / sizeof papers[0] };

static uint32_t count(const char *text, const char *what)
{
    uint32_t n = 0;
    for (const char *at = text; (at = strstr(at, what)) != NULL; at += strlen(what))
        n++;
    return n;
}

static void all_papers_have_a_page(void **state)
{
    (void)state;
    static char page[1 << 20];
    const outcome *o = run(ALL);
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    assert_true(read_file("all/PAPERS.md", page, sizeof page) > 1000);
    assert_int_equal(count(page, "measured by"), PAPERS);
    assert_int_equal(count(page, ", in 0 s"), 0);
    assert_true(count(page, "paper: ") > 30);
    assert_true(read_file("all/papers.html", page, sizeof page) > 1000);
    /* nothing is measured twice, but what is not marked as well measured */
    o = run(ALL);
    assert_int_equal(o->exit_status, 0);
    assert_int_equal(count(o->err, ": kept what was measured on"), PAPERS);
    write_file("all/volume/measured-well", "0123456789abcdef", 16); /* by another program */
    o = run(ALL);
    assert_int_equal(o->exit_status, 0);
    assert_int_equal(count(o->err, ": kept what was measured on"), PAPERS - 1);
    assert_null(strstr(o->err, "volume: kept"));
}

static void papers_have_their_own_scenes(void **state)
{
    (void)state;
    refuses("", "reproduce all --scene coffee --out none", "leave out --scene");
    assert_int_not_equal(access("none", F_OK), 0);
}

static void time_ends_it(void **state)
{
    (void)state;
    refuses("", "reproduce emc --quick --quiet --out none --time 0.001s",
            "--time was over before anything");
    refuses("", "reproduce all --quick --out none --time soon", "--time is 'soon'");
    /* what is kept counts as nothing: volume, the last paper, does not fit */
    write_file("all/volume/measured-well", "0123456789abcdef", 16);
    refuses("", ALL " --quiet --time 0.001s", "--time was over before volume was done");
    const outcome *o = run(ALL " --time 1h --quiet");
    assert_int_equal(o->exit_status, 0);
    assert_string_equal(o->err, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_papers_have_a_page),
        cmocka_unit_test(papers_have_their_own_scenes),
        cmocka_unit_test(time_ends_it),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
