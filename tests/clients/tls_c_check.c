/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Prints three frames that the C library reads over TLS, a line "INDEX PRODUCT HASH" for each plane.
 *   disparity_tls_c_check ADDRESS AUTHORITY CERTIFICATE KEY TOKEN-FILE
 */
#include <disparity_client.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static uint64_t fnv1a(const void* data, uint64_t bytes) {
    const uint8_t* at = data;
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    uint64_t i;
    for (i = 0; i < bytes; ++i) {
        hash = (hash ^ at[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static int fail(const char* what) {
    printf("%s: %s\n", what, disparity_last_error());
    return 1;
}

int main(int argc, char** argv) {
    const uint32_t products[] = {DISPARITY_PRODUCT_DISPARITY, DISPARITY_PRODUCT_LEFT_COLOUR};
    disparity_connect_options options;
    disparity_subscription subscription;
    disparity_frame* frame = disparity_frame_new();
    disparity_socket* client;
    int i;
    if (argc != 6 || frame == NULL) {
        return 2;
    }
    memset(&options, 0, sizeof options);
    options.authority = argv[2];
    /* A caller that was built when the structure ended here. */
    if (disparity_socket_open_with(argv[1], NULL, 60000, &options, sizeof options.authority) != NULL) {
        return fail("without a certificate");
    }
    if (disparity_socket_open_with(argv[1], NULL, 60000, NULL, 0) != NULL) {
        return fail("without options");
    }
    options.certificate = argv[3];
    options.key = argv[4];
    options.token_file = argv[5];
    client = disparity_socket_open_with(argv[1], "tls-c-check", 60000, &options, sizeof options);
    memset(&subscription, 0, sizeof subscription);
    subscription.products = products;
    subscription.product_count = 2;
    if (client == NULL || disparity_socket_subscribe(client, &subscription) != 0) {
        return fail("socket");
    }
    for (i = 0; i < 3; ++i) {
        disparity_frame_info info;
        disparity_plane plane;
        uint32_t k;
        if (disparity_socket_read(client, frame, 60000) != DISPARITY_FRAME) {
            return fail("read");
        }
        disparity_frame_get_info(frame, &info, sizeof info);
        for (k = 0; disparity_frame_plane_at(frame, k, &plane); ++k) {
            printf("%" PRIu64 " %u %016" PRIx64 "\n", info.publish_index, plane.product,
                   fnv1a(plane.data, plane.bytes));
        }
    }
    disparity_socket_close(client);
    disparity_frame_free(frame);
    return 0;
}
