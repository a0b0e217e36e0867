# Loads from global memory of each kernel in PTX, by width: NAME KERNEL COLUMN VALUE.
/\.entry/ {
    kernel = $0
    sub(/.*\.entry /, "", kernel)
    sub(/\(.*/, "", kernel)
    kernels[kernel] = 1
}
/\.func/ { kernel = "(functions)" }
/ld\.global/ {
    bits = $0 ~ /\.[a-z]64/ ? 64 : 32
    bytes = bits / 8 * ($0 ~ /\.v4\./ ? 4 : $0 ~ /\.v2\./ ? 2 : 1)
    loads[kernel, bytes > 8 ? 16 : bytes > 4 ? 8 : 4]++
    if ($0 !~ /\.nc\./)
        loads[kernel, "plain"]++
    kernels[kernel] = 1
}
END {
    split("16 8 4 plain", kinds)
    for (kernel in kernels)
        for (i = 1; i in kinds; i++)
            print name, kernel, "loads_" kinds[i], loads[kernel, kinds[i]] + 0
}
