/* The table of queries. */
#ifndef BB_QUERIES_H
#define BB_QUERIES_H

#include "framework/judge/query.h"

extern const bb_query bb_query_closest, bb_query_any;

extern const bb_query *const bb_queries[];       /* generated table; ends with NULL */
const bb_query *bb_query_find(const char *name); /* NULL if there is none */

#endif
