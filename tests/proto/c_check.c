/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Compiled as C. Prints one frame as the C library gives it, in the form that same_frame_test.cpp compares.
 *   disparity_c_check ADDRESS NAME-OF-SHARED-MEMORY
 */
#include <disparity_client.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static uint64_t fnv1a_on(uint64_t hash, const void* data, uint64_t bytes) {
    const uint8_t* at = data;
    uint64_t i;
    for (i = 0; i < bytes; ++i) {
        hash = (hash ^ at[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static uint64_t fnv1a(const void* data, uint64_t bytes) {
    return fnv1a_on(UINT64_C(0xcbf29ce484222325), data, bytes);
}

static uint64_t digest(const float* values, uint32_t width, uint32_t height) {
    return values == NULL ? 0 : fnv1a(values, (uint64_t)4 * width * height);
}

/* What is computed from the planes, to the last bit. */
static void print_metres(const char* way, disparity_frame* frame) {
    uint64_t places = UINT64_C(0xcbf29ce484222325), colours = places;
    uint64_t sums[3];
    uint32_t width = 0, height = 0, step, i;
    const float* values = disparity_frame_disparity_px(frame, &width, &height);
    sums[0] = digest(values, width, height);
    values = disparity_frame_depth_m(frame, &width, &height);
    sums[1] = digest(values, width, height);
    values = disparity_frame_depth_error_m(frame, &width, &height);
    sums[2] = digest(values, width, height);
    for (step = 1; step <= 3; step += 2) {
        const disparity_point* points = disparity_frame_points(frame, step, &width, &height);
        for (i = 0; points != NULL && i < width * height; ++i) {
            places = fnv1a_on(places, &points[i].x, 12);
            colours = fnv1a_on(colours, &points[i].red, 3);
        }
    }
    printf("%s metres %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n", way, sums[0],
           sums[1], sums[2], places, colours);
}

static void print_frame(const char* way, disparity_frame* frame) {
    disparity_frame_info f;
    disparity_plane plane;
    uint32_t i;
    disparity_frame_get_info(frame, &f, sizeof f);
    printf("%s %" PRIu64 " %" PRIu64 " %" PRId64 " %" PRId64 " %" PRId64 " %" PRIu64 " %" PRIu64
           " %.17g %.17g %.17g %.17g %.17g %d %u %d %u %u %u %u %u\n",
           way, f.publish_index, f.sequence, f.monotonic_ns, f.realtime_ns, f.age_ns, f.dropped_before,
           f.calibration_id, f.f, f.cx, f.cy, f.baseline_mm, f.disparity_offset, f.d_min, f.disparities, f.invalid,
           f.flags, f.width, f.height, f.region_x, f.region_y);
    for (i = 0; disparity_frame_plane_at(frame, i, &plane); ++i) {
        printf("%s plane %u %u %u %u %016" PRIx64 "\n", way, plane.product, plane.width, plane.height,
               plane.bytes_per_pixel, fnv1a(plane.data, plane.bytes));
    }
    print_metres(way, frame);
}

static int fail(const char* what) {
    fprintf(stderr, "disparity_c_check: %s: %s\n", what, disparity_last_error());
    return 1;
}

/* Mistakes of the caller are answered, not punished. */
static int check_errors(void) {
    disparity_plane plane;
    disparity_frame_info info;
    size_t bytes = 0;
    if (disparity_shared_memory_open("not/a/name") != NULL || strstr(disparity_last_error(), "not/a/name") == NULL) {
        return fail("a bad name is accepted, or not named");
    }
    if (disparity_socket_open("nonsense", NULL, 100) != NULL || strstr(disparity_last_error(), "nonsense") == NULL) {
        return fail("a bad address is accepted, or not named");
    }
    if (disparity_shared_memory_read(NULL, NULL, 0, NULL, 0) != DISPARITY_ERROR ||
        disparity_socket_read(NULL, NULL, 0) != DISPARITY_ERROR || disparity_socket_subscribe(NULL, NULL) == 0 ||
        disparity_socket_status(NULL, 0, &bytes) != NULL || disparity_frame_plane_at(NULL, 0, &plane) != 0) {
        return fail("NULL is accepted");
    }
    disparity_frame_get_info(NULL, &info, sizeof info);
    disparity_frame_free(NULL);
    disparity_socket_close(NULL);
    disparity_shared_memory_close(NULL);
    return 0;
}

/* What came before the frame was kept: two samples, into an array of one. */
static int check_sensors(disparity_socket* client) {
    disparity_sensor_sample sample;
    size_t count = 0;
    if (disparity_socket_read_sensors(client, &sample, sizeof sample, 1, &count, 0) != DISPARITY_FRAME || count != 1 ||
        sample.monotonic_ns != 1000 || sample.holds != DISPARITY_SENSOR_INERTIAL || sample.skipped != 3 ||
        sample.acceleration[2] != 9.75f || sample.hectopascal != 0) {
        return fail("first sample");
    }
    if (disparity_socket_read_sensors(client, &sample, sizeof sample, 1, &count, 0) != DISPARITY_FRAME || count != 1 ||
        sample.holds != (DISPARITY_SENSOR_ENVIRONMENT | DISPARITY_SENSOR_FRAME_SYNC) || sample.skipped != 0 ||
        sample.hectopascal != 1013.25f || sample.acceleration[2] != 0) {
        return fail("second sample");
    }
    if (disparity_socket_read_sensors(NULL, &sample, sizeof sample, 1, &count, 0) != DISPARITY_ERROR ||
        disparity_socket_read_sensors(client, NULL, sizeof sample, 1, &count, 0) != DISPARITY_ERROR ||
        disparity_socket_read_sensors(client, &sample, sizeof sample, 0, &count, 0) != DISPARITY_ERROR) {
        return fail("samples without room");
    }
    return 0;
}

/* The daemon ends the connection; reading on makes another one. */
static int check_return(disparity_socket* client, disparity_frame* frame) {
    if (disparity_socket_read(client, frame, 20000) != DISPARITY_ERROR) {
        return fail("the daemon's last words");
    }
    if (disparity_socket_read(client, frame, 20000) != DISPARITY_GONE ||
        strstr(disparity_last_error(), "the connection has ended") == NULL) {
        return fail("the end of the connection");
    }
    return disparity_socket_read(client, frame, 20000) == DISPARITY_FRAME ? 0 : fail("another connection");
}

/* A reader that may be there before the daemon. */
static int check_absence(const char* name) {
    char absent[100];
    disparity_frame* frame = disparity_frame_new();
    disparity_shared_memory* reader;
    snprintf(absent, sizeof absent, "%s-absent", name);
    if (disparity_shared_memory_open(absent) != NULL) {
        return fail("no shared memory");
    }
    reader = disparity_shared_memory_open_with(absent, NULL, 1);
    if (reader == NULL || disparity_shared_memory_read(reader, frame, 10, NULL, 0) != DISPARITY_GONE ||
        strstr(disparity_last_error(), "there is none") == NULL) {
        return fail("shared memory that may be absent");
    }
    disparity_shared_memory_close(reader);
    disparity_frame_free(frame);
    return 0;
}

/* A daemon that may be absent, and mistakes. */
static int check_door(void) {
    disparity_client_options options;
    disparity_subscription wanted;
    disparity_frame* frame = disparity_frame_new();
    disparity_sensor_sample sample;
    disparity_client* client;
    uint32_t width, height;
    size_t count = 0;
    memset(&options, 0, sizeof options);
    memset(&wanted, 0, sizeof wanted);
    options.may_be_absent = 1;
    client = disparity_connect_with("unix:/nonexistent/socket", &wanted, &options, sizeof options);
    if (client == NULL || disparity_client_read(client, frame, 0) != DISPARITY_GONE ||
        strstr(disparity_last_error(), "/nonexistent/socket") == NULL || disparity_client_where(client)[0] != '\0' ||
        disparity_client_read_sensors(client, &sample, sizeof sample, 1, &count, 0) != DISPARITY_GONE ||
        disparity_client_status(client, 0, &count) != NULL) {
        return fail("a daemon that may be absent");
    }
    wanted.status_interval_s = 1;
    if (disparity_client_subscribe(client, &wanted) != DISPARITY_ERROR ||
        disparity_connect("not a name", NULL, 0) != NULL || disparity_connect("x", NULL, 1) != NULL ||
        disparity_client_read(NULL, frame, 0) != DISPARITY_ERROR ||
        disparity_frame_depth_m(frame, &width, &height) != NULL ||
        disparity_frame_points(NULL, 1, &width, &height) != NULL) {
        return fail("mistakes at the front door");
    }
    disparity_client_close(client);
    disparity_client_close(NULL);
    disparity_frame_free(frame);
    return 0;
}

int main(int argc, char** argv) {
    const uint32_t products[] = {DISPARITY_PRODUCT_DISPARITY, DISPARITY_PRODUCT_CONFIDENCE,
                                 DISPARITY_PRODUCT_LEFT_COLOUR, DISPARITY_PRODUCT_DEPTH, DISPARITY_PRODUCT_DEPTH_ERROR};
    const uint32_t two[] = {DISPARITY_PRODUCT_DISPARITY, DISPARITY_PRODUCT_LEFT_COLOUR};
    disparity_client* door;
    disparity_subscription subscription;
    disparity_plane plane;
    disparity_frame* frame = disparity_frame_new();
    disparity_socket* client;
    disparity_shared_memory* reader;
    if (argc != 3 || frame == NULL || check_errors() != 0) {
        return 1;
    }
    client = disparity_socket_open(argv[1], "c-check", 20000);
    memset(&subscription, 0, sizeof subscription);
    subscription.products = products;
    subscription.product_count = 5;
    subscription.sensors = 1;
    if (client == NULL || disparity_socket_subscribe(client, &subscription) != 0 ||
        disparity_socket_read(client, frame, 20000) != DISPARITY_FRAME) {
        return fail("socket");
    }
    print_frame("socket", frame);
    if (check_sensors(client) != 0) {
        return 1;
    }
    if (check_return(client, frame) != 0) {
        return 1;
    }
    disparity_socket_close(client);

    reader = disparity_shared_memory_open(argv[2]);
    if (reader == NULL || disparity_shared_memory_read(reader, frame, 20000, NULL, 0) != DISPARITY_FRAME) {
        return fail("shared memory");
    }
    print_frame("shm", frame);
    if (disparity_shared_memory_read(reader, frame, 0, NULL, 0) != DISPARITY_TIMEOUT ||
        disparity_shared_memory_heartbeat_age_ns(reader) < 0) {
        return fail("second read");
    }
    disparity_shared_memory_close(reader);

    /* Without a copy; the frame outlives its reader, and takes a copy again. */
    reader = disparity_shared_memory_open(argv[2]);
    if (reader == NULL || disparity_shared_memory_borrow(reader, frame, 20000) != DISPARITY_FRAME) {
        return fail("borrowed frame");
    }
    disparity_shared_memory_close(reader);
    print_frame("borrowed", frame);
    if (disparity_frame_is_whole(frame) != 1 || disparity_frame_is_whole(NULL) != 0 ||
        disparity_shared_memory_borrow(NULL, frame, 0) != DISPARITY_ERROR) {
        return fail("whole frame");
    }

    door = disparity_connect(argv[2], two, 2);
    if (door == NULL || disparity_client_read(door, frame, 20000) != DISPARITY_FRAME ||
        strncmp(disparity_client_where(door), "shared memory ", 14) != 0) {
        return fail("front door");
    }
    print_frame("door", frame);
    disparity_client_close(door);
    if (check_door() != 0) {
        return 1;
    }

    /* Only what is asked for. */
    reader = disparity_shared_memory_open(argv[2]);
    if (reader == NULL || disparity_shared_memory_read(reader, frame, 20000, products + 1, 1) != DISPARITY_FRAME ||
        disparity_frame_get_plane(frame, DISPARITY_PRODUCT_DISPARITY, &plane) != 0 ||
        disparity_frame_get_plane(frame, DISPARITY_PRODUCT_CONFIDENCE, &plane) != 1 ||
        disparity_frame_is_whole(frame) != 1) {
        return fail("selection of products");
    }
    disparity_shared_memory_close(reader);
    disparity_frame_free(frame);
    return check_absence(argv[2]);
}
