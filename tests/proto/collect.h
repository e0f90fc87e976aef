// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "proto/shared_memory_reader.h"

/// Copies all planes of a frame, and its fields as they were published.
struct Collected {
    using Reader = disparityd::proto::ShmReader;

    disparityd::proto::FrameInfo frame{};
    std::map<std::uint32_t, std::vector<std::uint8_t>> planes;

    Reader::Result read(Reader& reader, std::chrono::nanoseconds timeout) {
        const Reader::Result result = reader.read(
            frame,
            [&](const disparityd::proto::ShmPlane& plane) {
                std::vector<std::uint8_t>& bytes = planes[plane.product];
                bytes.resize(plane.bytes);
                return bytes.data();
            },
            timeout);
        if (result == Reader::Result::frame) {
            frame.age_ns -= reader.waited_ns();
        }
        return result;
    }
};
