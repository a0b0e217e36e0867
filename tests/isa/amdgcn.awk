# Figures of each kernel in assembly for AMD, from its metadata: NAME KERNEL COLUMN VALUE.
function say(what, value) {
    print name, kernel, cpu "_" what, value
}
/\.group_segment_fixed_size:/ { bytes = $2 }
/^    \.name:/ { kernel = $2 }
/\.private_segment_fixed_size:/ { private = $2 }
/\.sgpr_spill_count:/ { scalars = $2 }
/\.vgpr_count:/ { registers = $2 }
/\.vgpr_spill_count:/ {
    say("vgprs", registers)
    say("arrays", private - 4 * $2)
    say("spills", $2 + scalars)
    say("local", bytes)
}
