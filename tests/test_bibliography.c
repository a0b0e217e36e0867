/* BibTeX of methods: what is read, and what is refused with a line that says where. */
#include "framework/builder/bibliography.h"
#include "tests/fixture.h"

#include <string.h>

static bb_bibliography *read_text(const char *text)
{
    static bb_bibliography read;
    read.count = 0;
    ASSERT_OK(bb_bibliography_read(&read, "made-up.bib", text));
    return &read;
}

static void refuses(const char *text, const char *named)
{
    bb_bibliography read = {.count = 0};
    assert_int_equal(bb_bibliography_read(&read, "made-up.bib", text), BB_INVALID);
    assert_non_null(strstr(bb_message(), "made-up.bib"));
    if (strstr(bb_message(), named) == NULL)
        fail_msg("'%s' does not name '%s'", bb_message(), named);
}

static void has(const bb_citation *citation, const char *name, const char *expected)
{
    char value[BB_CITED_MAX];
    bb_citation_value(citation, name, value);
    assert_string_equal(value, expected);
}

static void entries_are_read(void **state)
{
    (void)state;
    const bb_bibliography *read = read_text(
        "Outside entries, mail@example.org included, everything is a comment.\n"
        "@article{a1 , Author = {M{\\\"o}ller, T.}, title = \"On {BVH}s = , here\", year = 1997 }\n"
        "  @misc{b-2,\n  author = {{Two, Words}},\n  title = {T},\n  year = {2001},\n"
        "  doi = {10.1/x_(2)},\n}\n");
    assert_int_equal(read->count, 2);
    has(&read->entries[0], "key", "a1");
    has(&read->entries[0], "author", "M\\\"oller, T.");
    has(&read->entries[0], "title", "On BVHs = , here");
    has(&read->entries[0], "year", "1997");
    has(&read->entries[0], "doi", "");
    has(&read->entries[1], "key", "b-2");
    has(&read->entries[1], "doi", "10.1/x_(2)");
    assert_memory_equal(read->entries[1].text + read->entries[1].length - 3, ",\n}", 3);
    assert_int_equal(read_text("")->count, 0);
    /* as databases export it */
    read = read_text("@string{j = {Journal}}\n@comment{x}\n@PREAMBLE{\"y\"}\n"
                     "@misc{c, author = \"M{\\\"o}ller\", title = {T}, month = jul, year = 2002}");
    assert_int_equal(read->count, 1);
    has(&read->entries[0], "author", "M\\\"oller");
    has(&read->entries[0], "month", "jul");
}

#define ENTRY(key) "@misc{" key ", author = {A}, title = {T}, year = {2000}}\n"

static void papers_that_are_shared_come_once(void **state)
{
    (void)state;
    assert_int_equal(read_text(ENTRY("a") ENTRY("b") ENTRY("a"))->count, 2);
    const bb_bibliography *read = read_text("#include \"karras2013.bib\"\n"
                                            "#include \"karras2013.bib\"\n" ENTRY("a"));
    assert_int_equal(read->count, 2);
    has(&read->entries[0], "key", "karras2013");
    bb_bibliography none = {.count = 0};
    ASSERT_OK(bb_bibliography_add(&none, "no-such-method.bib"));
    assert_int_equal(none.count, 0);
    ASSERT_OK(bb_bibliography_add(&none, "llbvh.bib"));
    assert_int_equal(none.count, 1);
}

static void faults_are_named(void **state)
{
    (void)state;
    refuses("@misc{a, author = {A}, title = {T}, year = {2000}", "do not match");
    refuses("@misc{a, author = {A}, title = {T, year = {2000}}", "do not match");
    refuses("@misc", "do not match");
    refuses("@misc{}", "no entry");
    refuses("@misc{a}", "no entry");
    refuses("@misc{a, author = {A} title = {T}, year = {2000}}", "no entry");
    refuses("@misc{a, author = !A, title = {T}, year = {2000}}", "no entry");
    refuses("@misc{a, author = \"A, title = {T}, year = {2000}}", "no entry");
    refuses("@stray text\n@misc{a, author = {A}, title = {T}, year = {2000}}", "do not match");
    refuses("@misc{a, author = {A}, title = {T}, year = {2000}}}" ENTRY("b") "@misc{c", "{c");
    refuses("@misc{a, title = {T}, year = {2000}}", "a has no author");
    refuses("@misc{a, author = {A}, title = {}, year = {2000}}", "a has no title");
    refuses("@misc{a, author = {A}, title = {T}}", "a has no year");
    refuses(ENTRY("a") "@misc{a, author = {B}, title = {T}, year = {2000}}", "another entry a");
    refuses("#include \"nowhere.bib\"\n", "nowhere.bib");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(entries_are_read),
        cmocka_unit_test(papers_that_are_shared_come_once),
        cmocka_unit_test(faults_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
