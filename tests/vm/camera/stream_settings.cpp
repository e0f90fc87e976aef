// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/stream_settings.h"

#include <algorithm>
#include <cstdlib>

#include "tests/vm/camera/descriptors.h"

namespace simulated_camera {

namespace {

constexpr std::uint8_t probe_selector = 1;
constexpr std::uint8_t commit_selector = 2;

// The settings' fields: place and length.
constexpr std::size_t settings_bytes = 34;
constexpr std::size_t format_at = 2;
constexpr std::size_t frame_at = 3;
constexpr std::size_t interval_at = 4;
constexpr std::size_t frame_bytes_at = 18;
constexpr std::size_t payload_bytes_at = 22;
constexpr std::size_t clock_at = 26;
constexpr std::size_t framing_at = 30;

std::uint32_t nearest_interval(const Mode& mode, std::uint32_t wish) {
    std::uint32_t best = interval_of_rate(mode.rates[0]);
    for (const int rate : mode.rates) {
        const auto distance = [wish](std::uint32_t interval) {
            return std::abs(static_cast<std::int64_t>(interval) - static_cast<std::int64_t>(wish));
        };
        if (rate > 0 && distance(interval_of_rate(rate)) < distance(best)) {
            best = interval_of_rate(rate);
        }
    }
    return best;
}

}  // namespace

bool is_commit(const SetupPacket& setup) {
    return setup.is_class() && setup.index_low() == streaming_interface && setup.value_high() == commit_selector &&
           setup.request == uvc_request::set_cur;
}

StreamSettings::StreamSettings(const CameraOptions& camera)
    : camera_(camera), probe_(nearest(Bytes(settings_bytes))), commit_(probe_) {}

const Mode& StreamSettings::mode() const {
    return camera_.offered_modes()[commit_[frame_at] - 1U];
}

std::uint32_t StreamSettings::interval() const {
    return get_little_endian(commit_, interval_at, 4);
}

Bytes StreamSettings::nearest(Bytes wish) const {
    wish.resize(settings_bytes);
    const auto offered = camera_.offered_modes();
    if (wish[frame_at] < 1 || wish[frame_at] > offered.size()) {
        wish[frame_at] = 1;
    }
    wish[format_at] = 1;
    const Mode& mode = offered[wish[frame_at] - 1U];
    const std::uint32_t payload =
        camera_.transfer == Transfer::isochronous ? bytes_per_interval(camera_.link) : bulk_payload_bytes(camera_.link);
    put_little_endian(wish, interval_at, nearest_interval(mode, get_little_endian(wish, interval_at, 4)), 4);
    put_little_endian(wish, frame_bytes_at, mode.frame_bytes(), 4);
    put_little_endian(wish, payload_bytes_at, payload, 4);
    put_little_endian(wish, clock_at, 48'000'000, 4);
    put_little_endian(wish, framing_at, 3, 4);  // frame id and end of frame are told; no version, nothing preferred
    return wish;
}

ControlAnswer StreamSettings::answer(const SetupPacket& setup, std::span<const std::uint8_t> data) {
    const std::uint8_t selector = setup.value_high();
    if (selector != probe_selector && selector != commit_selector) {
        return std::nullopt;
    }
    Bytes& settings = selector == probe_selector ? probe_ : commit_;
    Bytes limit = probe_;
    switch (setup.request) {
        case uvc_request::set_cur: settings = nearest({data.begin(), data.end()}); return Bytes();
        case uvc_request::get_cur: return settings;
        case uvc_request::get_min: put_little_endian(limit, interval_at, 0, 4); return nearest(limit);
        case uvc_request::get_max: put_little_endian(limit, interval_at, 0xffff'ffff, 4); return nearest(limit);
        case uvc_request::get_def: return nearest({});
        case uvc_request::get_len: return Bytes{settings_bytes, 0};
        case uvc_request::get_info: return Bytes{readable_and_writable};
        default: return std::nullopt;
    }
}

}  // namespace simulated_camera
