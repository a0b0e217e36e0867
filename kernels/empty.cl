/* Does nothing, so that the harness can time a launch (framework/device/launch_cost.c). */
kernel void empty(uint unused)
{
    (void)unused;
}
