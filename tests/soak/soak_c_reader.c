/* SPDX-License-Identifier: Apache-2.0 */
/*
 * soak_c_reader shm:NAME|tcp:HOST:PORT|unix:PATH: reads frames with the C interface until its standard input ends, then
 * one more, and prints its account. The first frame is announced by the line "frame".
 */
#include <disparity_client.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { TURN_MS = 200, LONGEST_WAIT_S = 60 };

struct account {
    unsigned long long frames, skipped, first, last;
    double oldest_ms;
};

static int asked_to_end(void) {
    struct pollfd input = {STDIN_FILENO, POLLIN, 0};
    return poll(&input, 1, 0) > 0;
}

/* Returns 0 when the frame contradicts those before. */
static int add(struct account* account, const disparity_frame_info* info) {
    const double age_ms = (double)info->age_ns / 1e6;
    if (account->frames == 0) {
        account->first = info->publish_index;
    } else if (info->publish_index != account->last + 1 + info->skipped) {
        fprintf(stderr, "soak_c_reader: error: frame %llu with %llu skipped came after %llu\n",
                (unsigned long long)info->publish_index, (unsigned long long)info->skipped, account->last);
        return 0;
    } else {
        account->skipped += info->skipped;
    }
    account->frames++;
    account->last = info->publish_index;
    if (age_ms > account->oldest_ms) {
        account->oldest_ms = age_ms;
    }
    return 1;
}

static int next(disparity_shared_memory* memory, disparity_socket* client, disparity_frame* frame) {
    return memory != NULL ? disparity_shared_memory_read(memory, frame, TURN_MS, NULL, 0)
                          : disparity_socket_read(client, frame, TURN_MS);
}

static int follow(disparity_shared_memory* memory, disparity_socket* client, disparity_frame* frame,
                  struct account* account) {
    time_t end_by = 0;
    while (end_by == 0 || time(NULL) < end_by) {
        const int result = next(memory, client, frame);
        if (result == DISPARITY_FRAME) {
            disparity_frame_info info;
            disparity_frame_get_info(frame, &info, sizeof info);
            if (!add(account, &info)) {
                return 1;
            }
            if (account->frames == 1) {
                puts("frame");
                fflush(stdout);
            }
            if (end_by != 0) {
                return 0;
            }
        } else if (result != DISPARITY_TIMEOUT) {
            fprintf(stderr, "soak_c_reader: error: %s\n", disparity_last_error());
            return 1;
        }
        if (end_by == 0 && asked_to_end()) {
            end_by = time(NULL) + LONGEST_WAIT_S;
        }
    }
    fprintf(stderr, "soak_c_reader: error: no frame for %d s\n", LONGEST_WAIT_S);
    return 1;
}

int main(int argc, char** argv) {
    const uint32_t products[] = {DISPARITY_PRODUCT_DISPARITY, DISPARITY_PRODUCT_CONFIDENCE};
    disparity_subscription subscription;
    disparity_shared_memory* memory = NULL;
    disparity_socket* client = NULL;
    disparity_frame* frame = disparity_frame_new();
    struct account account;
    int status = 1;

    if (argc != 2) {
        fputs("usage: soak_c_reader shm:NAME|tcp:HOST:PORT|unix:PATH\n", stderr);
        return 2;
    }
    memset(&account, 0, sizeof account);
    memset(&subscription, 0, sizeof subscription);
    subscription.products = products;
    subscription.product_count = 2;
    if (strncmp(argv[1], "shm:", 4) == 0) {
        memory = disparity_shared_memory_open(argv[1] + 4);
    } else {
        client = disparity_socket_open(argv[1], "soak c", 5000);
    }
    if (frame == NULL || (memory == NULL && client == NULL) ||
        (client != NULL && disparity_socket_subscribe(client, &subscription) != 0)) {
        fprintf(stderr, "soak_c_reader: error: %s\n", disparity_last_error());
    } else {
        status = follow(memory, client, frame, &account);
    }
    if (status == 0) {
        printf("{\"frames\":%llu,\"skipped\":%llu,\"first\":%llu,\"last\":%llu,\"age_ms\":[0,0,%f],\"refusals\":[]}\n",
               account.frames, account.skipped, account.first, account.last, account.oldest_ms);
    }
    disparity_shared_memory_close(memory);
    disparity_socket_close(client);
    disparity_frame_free(frame);
    return status;
}
