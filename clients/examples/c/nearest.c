/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Prints the nearest measured depth of each frame, over a socket. Goes on when the daemon has been started again.
 *   nearest-c [tcp:HOST:PORT | tls:HOST:PORT | unix:PATH]
 */
#include <disparity_client.h>
#include <stdio.h>
#include <string.h>

/* In mm; 0 when nothing was measured. Confidence 0 marks pixels that were rejected or filled in. */
static unsigned nearest(const disparity_plane* depth, const disparity_plane* confidence) {
    const uint16_t* mm = depth->data;
    const uint8_t* measured = confidence->data;
    unsigned best = 0;
    for (uint64_t i = 0; i < confidence->bytes; ++i) {
        if (measured[i] != 0 && mm[i] != 0 && (best == 0 || mm[i] < best)) {
            best = mm[i];
        }
    }
    return best;
}

int main(int argc, char** argv) {
    const uint32_t products[] = {DISPARITY_PRODUCT_DEPTH, DISPARITY_PRODUCT_CONFIDENCE};
    disparity_socket* client = disparity_socket_open(argc > 1 ? argv[1] : "tcp:127.0.0.1:9876", "nearest-c", 5000);
    disparity_frame* frame = disparity_frame_new();
    disparity_subscription subscription;
    disparity_frame_info info;
    disparity_plane depth, confidence;
    int result = DISPARITY_ERROR;

    memset(&subscription, 0, sizeof subscription);
    subscription.products = products;
    subscription.product_count = 2;
    if (client != NULL && frame != NULL && disparity_socket_subscribe(client, &subscription) == 0) {
        while ((result = disparity_socket_read(client, frame, 1000)) != DISPARITY_ERROR) {
            if (result == DISPARITY_TIMEOUT) {
                puts("no frame for a second");
            } else if (result == DISPARITY_GONE) { /* the next read connects again and subscribes as before */
                printf("waiting for the daemon: %s\n", disparity_last_error());
            } else {
                disparity_frame_get_info(frame, &info, sizeof info);
                if (disparity_frame_get_plane(frame, DISPARITY_PRODUCT_DEPTH, &depth) &&
                    disparity_frame_get_plane(frame, DISPARITY_PRODUCT_CONFIDENCE, &confidence)) {
                    printf("frame %llu  %.1f ms old  nearest %u mm\n", (unsigned long long)info.sequence,
                           (double)info.age_ns / 1e6, nearest(&depth, &confidence));
                }
            }
            fflush(stdout);
        }
    }
    fprintf(stderr, "nearest-c: error: %s\n", disparity_last_error());
    disparity_frame_free(frame);
    disparity_socket_close(client);
    return 1;
}
