/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Prints the nearest measured point of each frame. Goes on when the daemon has been started again.
 *   nearest-c [NAME | unix:PATH | tcp:HOST:PORT | tls:HOST:PORT]
 */
#include <disparity_client.h>
#include <math.h>
#include <stdio.h>

/* Its z is NaN when nothing was measured. Confidence 0 marks pixels that were rejected or filled in. */
static disparity_point nearest(const disparity_point* points, const disparity_plane* confidence) {
    const uint8_t* measured = confidence->data;
    disparity_point best = {NAN, NAN, NAN, 0, 0, 0, 0};
    for (uint64_t i = 0; i < confidence->bytes; ++i) {
        if (measured[i] != 0 && (points[i].z < best.z || isnan(best.z))) {
            best = points[i];
        }
    }
    return best;
}

int main(int argc, char** argv) {
    const uint32_t products[] = {DISPARITY_PRODUCT_DISPARITY, DISPARITY_PRODUCT_CONFIDENCE};
    disparity_client* daemon = disparity_connect(argc > 1 ? argv[1] : "", products, 2);
    disparity_frame* frame = disparity_frame_new();
    int result = DISPARITY_ERROR;
    while (daemon != NULL && (result = disparity_client_read(daemon, frame, 1000)) != DISPARITY_ERROR) {
        uint32_t width, height;
        disparity_plane confidence;
        disparity_frame_info info;
        if (result == DISPARITY_TIMEOUT) {
            puts("no frame for a second");
        } else if (result == DISPARITY_GONE) { /* the next read looks for it again */
            printf("waiting for the daemon: %s\n", disparity_last_error());
        } else {
            const disparity_point* points = disparity_frame_points(frame, 1, &width, &height);
            if (points == NULL || !disparity_frame_get_plane(frame, DISPARITY_PRODUCT_CONFIDENCE, &confidence)) {
                break;
            }
            const disparity_point point = nearest(points, &confidence);
            disparity_frame_get_info(frame, &info, sizeof info);
            printf("frame %llu  %.1f ms old  nearest %.3f m, %.3f m to the right\n", (unsigned long long)info.sequence,
                   (double)info.age_ns / 1e6, point.z, point.x);
        }
        fflush(stdout);
    }
    fprintf(stderr, "nearest-c: error: %s\n", disparity_last_error());
    disparity_frame_free(frame);
    disparity_client_close(daemon);
    return 1;
}
