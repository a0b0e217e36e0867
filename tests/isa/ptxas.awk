# Figures of each kernel from what `ptxas -v` says: NAME KERNEL COLUMN VALUE.
/ error/ {
    print "isa: " name ": " $0 >"/dev/stderr"
    exit 1
}
/Compiling entry/ {
    split($0, part, "\047")
    kernel = part[2]
}
/stack frame/ {
    match($0, /[0-9]+ bytes stack/)
    stack = substr($0, RSTART) + 0
    match($0, /[0-9]+ bytes spill stores/)
    spills = substr($0, RSTART) + 0
}
/Used [0-9]+ registers/ {
    match($0, /Used [0-9]+/)
    print name, kernel, "sm_90_registers", substr($0, RSTART + 5) + 0
    print name, kernel, "sm_90_stack", stack
    print name, kernel, "sm_90_spills", spills
}
