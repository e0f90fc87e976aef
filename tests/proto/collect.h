// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "proto/shared_memory_reader.h"

/// Copies all planes of a frame.
struct Collected {
    using Reader = disparityd::proto::ShmReader;

    disparityd::proto::FrameInfo frame{};
    std::map<std::uint32_t, std::vector<std::uint8_t>> planes;

    Reader::Result read(Reader& reader, std::chrono::nanoseconds timeout) {
        return reader.read(
            frame,
            [&](const disparityd::proto::ShmPlane& plane) {
                std::vector<std::uint8_t>& bytes = planes[plane.product];
                bytes.resize(plane.bytes);
                return bytes.data();
            },
            timeout);
    }
};
