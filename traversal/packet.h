/* Shared by the kernels of kernels/packet.cl, each of which is declared in its own
 * kernel_NAME.c. */
#ifndef BB_PACKET_H
#define BB_PACKET_H

#include "traversal/traversal.h"

enum { BB_PACKET_MOST = 16 }; /* rays of a packet */

#define BB_PACKET_OPTIONS                                                                          \
    {"rays", "auto", "auto|8|16",                                                                  \
     "rays of a packet; auto: 16 where vectors have 16 lanes, else 8; simulated: 8"},              \
    {                                                                                              \
        "few", "4", "0|1|2|3|4|5|6|8", "rays left in a packet that are traced one by one"          \
    }

/* For CPUs only: a packet is the work of many lanes, of which a work-item of a GPU has one. */
#define BB_PACKET_KERNEL                                                                           \
    .summary = "packets of rays side by side, bounded by intervals: for CPUs",                     \
    .paper = "Wald et al. 2001; Boulos et al. 2006; Benthin et al. 2012", .source = "packet.cl",   \
    .queries = BB_ALONG_RAYS, .ordered = true, .batched = true, .control = BB_PACKETS

#endif
