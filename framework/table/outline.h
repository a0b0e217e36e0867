/* Outlines: how the table of a command becomes a page, as constant data. */
#ifndef BB_OUTLINE_H
#define BB_OUTLINE_H

#include "framework/table/view.h"

typedef struct bb_page_outline {
    const char *command;        /* whose tables it shows */
    const char *title;          /* "bvhbench: slices of meshes" */
    bool by_question;           /* its sections are of questions; else of scenes */
    const bb_table_view *views; /* for each scene, one after the other */
    uint32_t view_count;
    uint32_t most; /* rows of a view that are shown; 0: all */
    /* Says in sentences what a scene's rows mean, before its views; NULL: nothing. */
    void (*say)(const bb_table *table, const char *scene, bb_page *page);
    const char *note;  /* how the figures are to be read; NULL: nothing is said */
    const char *wrong; /* a column of numbers: how many answers of a row are wrong; rows whose
                        * "status" is "failed" are wrong, too. NULL: there is no verdict but what
                        * `say` says */
    const char *well;  /* the verdict if none is: "All answers are the same." */
    const char *ill;   /* what follows their number: "answers differ" */
} bb_page_outline;

/* A scene: its figures, all views, its pictures, which rows name in the column "picture". */
void bb_outline_scene(const bb_page_outline *outline, const bb_table *table, const char *scene,
                      bb_page *page);
/* All of it: what belongs to the whole run, the verdict, scenes. Owned by the caller. */
bb_status bb_outline_page(const bb_page_outline *outline, const bb_table *table, bb_page **out);

/* Whether any answer is wrong, or any row failed. */
bool bb_outline_is_wrong(const bb_page_outline *outline, const bb_table *table);

#endif
