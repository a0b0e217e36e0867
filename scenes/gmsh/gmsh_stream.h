/* The output of the helper that reads meshes with Gmsh's library (gmsh_reader.c), in the host's
 * byte order: this header, then the vertices (x y z), the field if there is one, and the tetrahedra
 * as indices of vertices. The helper is a separate process, so that a file that crashes Gmsh causes
 * an error line and not a crash. */
#ifndef BB_GMSH_STREAM_H
#define BB_GMSH_STREAM_H

#include <stdint.h>

#define BB_GMSH_MAGIC "BVHBGMSH"

typedef struct bb_gmsh_head {
    char magic[8]; /* not terminated */
    uint64_t vertices;
    uint64_t tets;
    uint64_t others;   /* elements that are neither tetrahedra nor of a lower dimension */
    uint64_t fielded;  /* 1: there is a field, float[vertices] */
    char message[240]; /* the error; "": none, and data follow */
} bb_gmsh_head;

enum { BB_GMSH_TET_4 = 4, BB_GMSH_TET_10 = 11 }; /* Gmsh's numbers of element types */

#endif
