/* Files of views. What is read can be written down and read again, to the last bit. */
#include "framework/scene/camera.h"
#include "framework/scene/scene.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>

static int write_vector(char *text, size_t room, const char *key, const double v[3])
{
    return snprintf(text, room, " %s=%.17g,%.17g,%.17g", key, v[0], v[1], v[2]);
}

static size_t write_view(char *text, size_t room, const bb_view *view)
{
    size_t used = (size_t)snprintf(text, room, "%s", view->name);
    used += (size_t)write_vector(text + used, room - used, "eye", view->eye);
    used += (size_t)write_vector(text + used, room - used, "target", view->target);
    used += (size_t)write_vector(text + used, room - used, "up", view->up);
    used += (size_t)snprintf(text + used, room - used, " %s=%.17g\n",
                             view->parallel ? "parallel" : "fov", view->fov_y);
    return used;
}

static bool is_same(const bb_view *a, const bb_view *b)
{
    return strcmp(a->name, b->name) == 0 && memcmp(a->eye, b->eye, sizeof a->eye) == 0 &&
           memcmp(a->target, b->target, sizeof a->target) == 0 &&
           memcmp(a->up, b->up, sizeof a->up) == 0 &&
           memcmp(&a->fov_y, &b->fov_y, sizeof a->fov_y) == 0 && a->parallel == b->parallel;
}

/* A camera can be made of each view, or the refusal says why not. */
static void make_camera(const bb_view *view)
{
    bb_camera camera;
    bb_status status = bb_camera_make(view, 16, 9, &camera);
    if (status != BB_OK)
        fuzz_refused(status);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char text[BB_VIEWS_MAX * 1024];
    bb_view views[BB_VIEWS_MAX], again[BB_VIEWS_MAX];
    uint32_t count = 0, count_again = 0;
    bb_status status =
        bb_views_read(fuzz_file("scene.views", data, size), views, BB_VIEWS_MAX, &count);
    if (status != BB_OK) {
        fuzz_refused(status);
        FUZZ_CHECK(count == 0);
        return 0;
    }
    FUZZ_CHECK(count > 0 && count <= BB_VIEWS_MAX);
    size_t used = 0;
    for (uint32_t i = 0; i < count; i++) {
        make_camera(&views[i]);
        used += write_view(text + used, sizeof text - used, &views[i]);
    }
    FUZZ_CHECK(bb_views_read(fuzz_file("again.views", text, used), again, BB_VIEWS_MAX,
                             &count_again) == BB_OK);
    FUZZ_CHECK(count_again == count);
    for (uint32_t i = 0; i < count; i++)
        FUZZ_CHECK(is_same(&views[i], &again[i]));
    return 0;
}
