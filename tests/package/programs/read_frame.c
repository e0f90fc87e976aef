/* SPDX-License-Identifier: Apache-2.0 */
/* Reads one frame over a socket and says how large its depth is: read_frame ADDRESS */
#include <disparity_client.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char** argv) {
    const uint32_t depth_only[] = {DISPARITY_PRODUCT_DEPTH};
    disparity_subscription subscription;
    disparity_plane depth;
    disparity_socket* client = disparity_socket_open(argv[argc - 1], "read_frame", 20000);
    disparity_frame* frame = disparity_frame_new();
    memset(&subscription, 0, sizeof subscription);
    subscription.products = depth_only;
    subscription.product_count = 1;
    if (client == NULL || frame == NULL || disparity_socket_subscribe(client, &subscription) != 0 ||
        disparity_socket_read(client, frame, 20000) != DISPARITY_FRAME ||
        !disparity_frame_get_plane(frame, DISPARITY_PRODUCT_DEPTH, &depth)) {
        fprintf(stderr, "read_frame: error: %s\n", disparity_last_error());
        return 1;
    }
    printf("depth of %ux%u\n", depth.width, depth.height);
    return 0;
}
