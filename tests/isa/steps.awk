# Instructions of each step of a traversal, from assembly for gfx1030 in which BB_MARKING has left a
# comment at each: NAME KERNEL COLUMN VALUE, where COLUMN is step_KIND. A step costs all instructions
# of the loop that it is in, but for those of loops inside. If a loop has steps of several kinds, the
# first has them all: node, prims, pop, push, restart, sample, again; of several loops with samples
# the longest counts. Loops without a step belong to the step that they are inside of; those right
# around a step's loop, also if another search begins there, to the pops, or the nodes; others, and
# what is in no loop, to a ray's beginning. In searches of tetrahedra (`prefix` is given, and COLUMN
# is prefix_KIND) the longest loop of each kind counts, since loops are there twice for trees of one
# node, and one in which another search begins has what is done with the answer.
/^[A-Za-z_][A-Za-z0-9_]*:/ {
    name_of = $1
    sub(/:.*/, "", name_of)
    in_kernel = name_of ~ /^(trace|march_all|slice_tets|overlap_tets|tet_march)$/
    if (in_kernel) kernel = name_of
    loop = ""
}
!in_kernel { next }
/s_swappc/ {
    print "isa: " name ": kernel " kernel " calls a function, whose instructions are not counted" >"/dev/stderr"
    bad = 1
    exit 1
}
/s_endpgm/ { counts[""]++; in_kernel = 0; next }
# a block: its label or number, and what the comments behind it say of its loop
/^\.LBB[0-9_]+:/ || /^; %bb\./ {
    block = $1
    sub(/^\.L/, "", block)
    sub(/:.*/, "", block)
    loop = above = ""
}
/Parent Loop/ {
    above = $0
    sub(/.*Parent Loop /, "", above)
    sub(/ .*/, "", above)
}
/in Loop: Header=/ {
    loop = $0
    sub(/.*Header=/, "", loop)
    sub(/ .*/, "", loop)
}
/This (Inner )?Loop Header/ {
    loop = block
    parent[loop] = above
}
/^\t; bb_step / || /^[ \t]*; BB_STEP_/ {
    kind = $2
    loop_of[kind, ++places[kind]] = loop
    next
}
/^\t[a-z]/ && !/^\t[.;]/ { counts[loop]++ }
END {
    if (bad) exit 1
    if (kernel == "") exit
    tets = prefix != ""
    many = split(tets ? "AGAIN NODE BOX PRIMS POP PUSH RESTART LEAF" \
                      : "NODE PRIMS POP PUSH RESTART SAMPLE AGAIN", kinds, " ")
    for (k = 1; k <= many; k++) {
        kind = "BB_STEP_" kinds[k]
        for (i = 1; i <= places[kind]; i++) {
            at = loop_of[kind, i]
            if (at in owner || at == "" || (!tets && kinds[k] == "AGAIN" && at in holds)) continue
            holds[parent[at]] = 1
            owner[at] = k
            whole[at] = counts[at]
        }
    }
    around = tets ? 2 : places["BB_STEP_POP"] > 0 ? 3 : 1
    for (at in counts) {
        if (at == "" || at in owner) continue
        outer = parent[at]
        while (outer != "" && !(outer in owner)) outer = parent[outer]
        if (outer != "") whole[outer] += counts[at]
        else if (at in holds) cost[around] += counts[at]
        else counts[""] += counts[at]
    }
    for (at in owner) {
        k = owner[at]
        longest = whole[at] > loops[k] ? whole[at] : loops[k] + 0
        loops[k] = tets || kinds[k] == "SAMPLE" ? longest : loops[k] + whole[at]
    }
    for (k = 1; k <= many; k++)
        cost[k] += loops[k]
    for (k = 1; k <= many; k++)
        print name, kernel, (tets ? prefix : "step") "_" tolower(kinds[k]), cost[k]
    print name, kernel, "step_begin", counts[""]
}
