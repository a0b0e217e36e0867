/* Letters that steer a terminal. */
#include "framework/base/steering.h"

#include <stdbool.h>

int bb_steering_bytes(const char *text)
{
    const unsigned char c = (unsigned char)text[0], d = (unsigned char)text[c != 0];
    const unsigned char e = (unsigned char)text[c != 0 && d != 0 ? 2 : 0];
    if (c < 0x20 || c == 0x7F)
        return 1;
    if (c == 0xC2 && d >= 0x80 && d <= 0x9F) /* U+0080 to U+009F */
        return 2;
    bool turns = d == 0x80 && e >= 0xAA && e <= 0xAE;    /* U+202A to U+202E */
    bool isolates = d == 0x81 && e >= 0xA6 && e <= 0xA9; /* U+2066 to U+2069 */
    return c == 0xE2 && (turns || isolates) ? 3 : 0;
}

void bb_calm_text(char *text)
{
    char *to = text;
    while (*text != '\0') {
        const int steering = bb_steering_bytes(text);
        *to++ = steering > 0 ? '?' : *text;
        text += steering > 0 ? steering : 1;
    }
    *to = '\0';
}
