/* Before Embree (LD_PRELOAD): what a library lacks, or does not do. Variables:
 *   LACKING_RAY8=1        packets of 8 rays are not supported
 *   LACKING_FAILS=N       the N-th commit of a scene whose geometry was marked as changed reports
 *                         an error; trees that are built once, as the oracle's, are not counted
 *   LACKING_INTERRUPTS=N  during that commit the program gets SIGTERM
 */
#include "framework/judge/embree_api.h"

#include <dlfcn.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static RTCErrorFunction report;
static void *reported_to;
static bool changed;
static long commits;

static long number_of(const char *variable)
{
    const char *text = getenv(variable);
    return text != NULL ? strtol(text, NULL, 10) : 0;
}

/* Puts Embree's own function into a pointer. */
static void find(const char *name, void *pointer)
{
    void *function = dlsym(RTLD_NEXT, name);
    if (function == NULL)
        abort();
    memcpy(pointer, &function, sizeof function);
}

ssize_t rtcGetDeviceProperty(RTCDevice device, enum RTCDeviceProperty property)
{
    ssize_t (*get)(RTCDevice, enum RTCDeviceProperty);
    find("rtcGetDeviceProperty", &get);
    if (property == RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED && number_of("LACKING_RAY8") != 0)
        return 0;
    return get(device, property);
}

void rtcSetDeviceErrorFunction(RTCDevice device, RTCErrorFunction error, void *user)
{
    void (*set)(RTCDevice, RTCErrorFunction, void *);
    find("rtcSetDeviceErrorFunction", &set);
    report = error;
    reported_to = user;
    set(device, error, user);
}

void rtcUpdateGeometryBuffer(RTCGeometry geometry, enum RTCBufferType type, unsigned int slot)
{
    void (*update)(RTCGeometry, enum RTCBufferType, unsigned int);
    find("rtcUpdateGeometryBuffer", &update);
    changed = true;
    update(geometry, type, slot);
}

void rtcCommitScene(RTCScene scene)
{
    void (*commit)(RTCScene);
    find("rtcCommitScene", &commit);
    commits += changed;
    if (changed && commits == number_of("LACKING_FAILS"))
        report(reported_to, RTC_ERROR_UNKNOWN, "made to fail");
    if (changed && commits == number_of("LACKING_INTERRUPTS"))
        kill(getpid(), SIGTERM);
    changed = false;
    commit(scene);
}
