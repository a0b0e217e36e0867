# Holds what scripts/isa measured (NAME KERNEL COLUMN VALUE) against the table, or writes it anew
# (write=yes). Rows `limit` are what is asked for; of the others each figure is what that clang made
# of it. -: no figure, or no limit.
BEGIN {
    OFS = "\t"
    SUBSEP = " "
}
NR == FNR {
    key = $1 SUBSEP $2
    found[key] = 1
    if (!((key, $3) in measured) || measured[key, $3] + 0 < $4 + 0)
        measured[key, $3] = $4
    next
}
/^#/ {
    comments[++comment_count] = $0
    next
}
!columns {
    columns = NF
    split($0, title)
    heading = $0
    next
}
{
    rows[++row_count] = $0
    key = $2 SUBSEP $3
    if ($1 == "limit") {
        limited[key] = 1
        for (i = 4; i <= NF; i++)
            if ($i != "-") limit[key, i] = $i
    }
    if ($1 == clang) {
        known[key] = 1
        for (i = 4; i <= NF; i++) ceiling[key, i] = $i
    }
}
function complain(text) {
    print "isa: clang " clang ": " text >"/dev/stderr"
    bad = 1
}
# What sm_90 has stays where there is no ptxas.
function figure(key, i) {
    if ((key, title[i]) in measured) return measured[key, title[i]]
    return ptxas == "no" && title[i] ~ /^sm_90/ && (key, i) in ceiling ? ceiling[key, i] : "-"
}
function compare(key, i, value,   most) {
    if ((key, i) in limit && value + 0 > limit[key, i] + 0)
        complain(key ": " title[i] " is " value ", and may be " limit[key, i] " at most")
    if (write == "yes" || !(key in known) || !((key, title[i]) in measured)) return
    most = ceiling[key, i] + 0
    if (value + 0 > most)
        complain(key ": " title[i] " is " value ", above " most " in kernels/isa.tsv")
    else if (value < 0.75 * most - 8)
        complain(key ": " title[i] " is " value ": lower " most " in kernels/isa.tsv")
}
END {
    for (key in found) {
        for (i = 4; i <= columns; i++)
            if (figure(key, i) != "-") compare(key, i, figure(key, i))
        if (write == "no" && !(key in known))
            complain(key ": no row in kernels/isa.tsv: scripts/isa --write --clang " clang " makes one")
    }
    for (key in known)
        if (write == "no" && !(key in found))
            complain(key ": its row in kernels/isa.tsv is of no kernel that was built")
    for (key in limited)
        if (!(key in found)) complain(key ": a limit of no kernel that was built")
    for (i = 1; i <= comment_count; i++) print comments[i]
    print heading
    for (i = 1; i <= row_count; i++)
        if (rows[i] ~ /^limit\t/) print rows[i]
    sorted = "sort -t '\t' -k1,1n -k2,3"
    for (i = 1; i <= row_count; i++)
        if (rows[i] !~ "^(limit|" clang ")\t") print rows[i] | sorted
    for (key in found) {
        line = key
        sub(SUBSEP, OFS, line)
        line = clang OFS line
        for (i = 4; i <= columns; i++) line = line OFS figure(key, i)
        print line | sorted
    }
    close(sorted)
    exit bad
}
