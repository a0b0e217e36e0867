#include "aac_goal.h"

#include <math.h>

enum { POWER_BITS = 40 };

/* Returns x^power for 0 <= power < 1, as the product of x^(1/2), x^(1/4) ... for the bits of the
 * power. The library's pow() may round differently on other machines. */
static double root_power(double x, double power)
{
    double result = 1, root = x;
    for (int bit = 0; bit < POWER_BITS; bit++) {
        root = sqrt(root);
        power *= 2;
        if (power >= 1) {
            power -= 1;
            result *= root;
        }
    }
    return result;
}

uint32_t aac_goal(const aac_law *law, uint32_t size)
{
    double ratio = (double)size / law->delta, power = 0.5 - law->epsilon;
    double scale = ratio >= 1 ? root_power(ratio, power) : 1 / root_power(1 / ratio, power);
    double goal = floor(0.5 * law->delta * scale + 0.5);
    return goal < 1 ? 1 : (uint32_t)goal;
}

uint32_t aac_goal_size(const aac_law *law, uint32_t goal, uint32_t most)
{
    uint32_t low = 1, high = most;
    if (aac_goal(law, most) < goal)
        return 0;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (aac_goal(law, middle) >= goal)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}
