// SPDX-License-Identifier: Apache-2.0
//
// Compiled as C++17: programs of users need no newer language for the client library.
#include <disparity_client.h>
#include <disparity_client.hpp>

static_assert(__cplusplus == 201703L);

/// Uses the types, so that they are complete.
disparity::ReadResult read_both(disparity::SharedMemoryReader& reader, disparity::Frame& copied,
                                disparity::BorrowedFrame& borrowed) {
    const auto timeout = std::chrono::milliseconds(0);
    const disparity::ReadResult result = reader.read(copied, timeout);
    return result == disparity::ReadResult::frame ? reader.borrow(borrowed, timeout) : result;
}
