# LLVM's text, read twice, with all but kernels internal, as drivers have it: a function that is
# inlined everywhere is gone.
NR == FNR {
    if (match($0, /@[A-Za-z0-9_]+, !"kernel"/)) {
        name = substr($0, RSTART + 1)
        sub(/,.*/, "", name)
        kernels[name] = 1
    }
    next
}
/^define / {
    name = $0
    sub(/^[^@]*@/, "", name)
    sub(/\(.*/, "", name)
    if (!(name in kernels) && $0 !~ /_kernel / && $0 !~ /^define (internal|linkonce)/)
        sub(/^define ((dso_local|hidden|protected) )*/, "define internal ")
}
{ print }
