// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <stdexcept>
#include <variant>

#include "clients/cpp/disparity_client.h"
#include "clients/cpp/disparity_client.hpp"
#include "proto/frame_info.h"

struct disparity_shared_memory {
    disparity::SharedMemoryReader reader;
    std::vector<disparity::Product> wanted;
};

struct disparity_socket {
    disparity::SocketClient client;
    std::string status;
    disparity::SensorBatch sensors;
    std::size_t sensors_read = 0;
};

struct disparity_client {
    disparity::Client client;
    std::string status;
    disparity::SensorBatch sensors;
    std::size_t sensors_read = 0;
    std::string where;
};

struct disparity_frame {
    std::variant<disparity::Frame, disparity::BorrowedFrame> frame;
    disparity::FloatImage disparity_px;  // what was computed last, for the caller
    disparity::FloatImage depth_m;
    disparity::FloatImage depth_error_m;
    disparity::Points points;
};

namespace {

static_assert(sizeof(disparity_frame_info) == 144 && sizeof(disparity_plane) == 32 &&
                  sizeof(disparity_subscription) == 56 && sizeof(disparity_sensor_sample) == 104 &&
                  sizeof(disparity_connect_options) == 6 * sizeof(char*) && sizeof(disparity_scan_info) == 52 &&
                  sizeof(disparity_scan_sector) == 48 && sizeof(disparity_point) == 16 &&
                  sizeof(disparity_client_options) == 24 + sizeof(disparity_connect_options) &&
                  sizeof(disparity_inertial_calibration) == 152,
              "part of the binary interface");
static_assert(sizeof(disparity::Point) == sizeof(disparity_point) && offsetof(disparity::Point, z) == 8 &&
                  offsetof(disparity::Point, red) == offsetof(disparity_point, red) &&
                  offsetof(disparity::Point, blue) == offsetof(disparity_point, blue),
              "points are given as they are");

std::string& error_text() {
    thread_local std::string text;
    return text;
}

void note_error() noexcept {
    try {
        try {
            throw;
        } catch (const std::bad_alloc&) {
            error_text() = "not enough memory";
        } catch (const std::exception& error) {
            error_text() = error.what();
        } catch (...) {
            error_text() = "unknown error";
        }
    } catch (...) {
        // There is no memory for the text either: the caller still gets the result code.
    }
}

/// Runs a call and returns `failure` when it throws: no exception may leave a C function.
template <class Result, class Call>
Result guarded(Result failure, Call&& call) noexcept {
    try {
        return call();
    } catch (...) {
        note_error();
        return failure;
    }
}

template <class T>
T& given(T* object, const char* what) {
    if (object == nullptr) {
        throw std::invalid_argument(std::string(what) + " is NULL");
    }
    return *object;
}

/// Makes it a frame of this kind; one of the other kind gives up what it holds.
template <class Kind>
Kind& as(disparity_frame* frame) {
    auto& held = given(frame, "frame").frame;
    if (!std::holds_alternative<Kind>(held)) {
        held = Kind();  // never without a value: neither kind throws when it is moved
    }
    return std::get<Kind>(held);
}

int code(disparity::ReadResult result, const std::string& why_gone) {
    switch (result) {
        case disparity::ReadResult::frame: return DISPARITY_FRAME;
        case disparity::ReadResult::timeout: return DISPARITY_TIMEOUT;
        case disparity::ReadResult::gone: break;
    }
    error_text() = why_gone;
    return DISPARITY_GONE;
}

template <class Plane>
int describe(const Plane* from, disparity_plane* plane) {
    if (from == nullptr || plane == nullptr) {
        return 0;
    }
    plane->product = static_cast<std::uint32_t>(from->product);
    plane->width = from->width;
    plane->height = from->height;
    plane->bytes_per_pixel = from->bytes_per_pixel;
    plane->data = from->bytes.data();
    plane->bytes = from->bytes.size();
    return 1;
}

void put_vector(const disparity::SensorVector& from, float (&to)[3]) {
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

disparity_sensor_sample in_c(const disparity::SensorSample& from) {
    disparity_sensor_sample to{};
    to.monotonic_ns = from.monotonic_ns;
    to.realtime_ns = from.realtime_ns;
    to.camera_ns = from.camera_ns;
    to.lost_before = from.lost_before;
    to.frame_syncs = from.frame_syncs;
    to.holds = from.frame_sync ? DISPARITY_SENSOR_FRAME_SYNC : 0;
    if (from.inertial) {
        to.holds |= DISPARITY_SENSOR_INERTIAL;
        put_vector(from.inertial->angular_velocity, to.angular_velocity);
        put_vector(from.inertial->acceleration, to.acceleration);
        to.imu_celsius = from.inertial->celsius;
    }
    if (from.magnetic_field) {
        to.holds |= DISPARITY_SENSOR_MAGNETIC;
        put_vector(*from.magnetic_field, to.magnetic_field);
    }
    if (from.environment) {
        to.holds |= DISPARITY_SENSOR_ENVIRONMENT;
        to.celsius = from.environment->celsius;
        to.hectopascal = from.environment->hectopascal;
        to.humidity_percent = from.environment->humidity_percent;
    }
    if (from.eye_temperatures) {
        to.holds |= DISPARITY_SENSOR_EYE_TEMPERATURE;
        to.left_celsius = from.eye_temperatures->left_celsius;
        to.right_celsius = from.eye_temperatures->right_celsius;
    }
    return to;
}

std::string text(const char* given_text) {
    return given_text == nullptr ? "" : given_text;
}

disparity::ConnectOptions in_cpp(const disparity_connect_options& from) {
    return {text(from.authority),   text(from.certificate), text(from.key),
            text(from.server_name), text(from.token_file),  text(from.token)};
}

disparity::Subscription in_cpp(const disparity_subscription& from) {
    disparity::Subscription wanted;
    wanted.products.clear();
    if (from.product_count != 0) {
        given(from.products, "products");
    }
    for (uint64_t i = 0; i < from.product_count; ++i) {
        wanted.products.push_back(static_cast<disparity::Product>(from.products[i]));
    }
    wanted.max_rate = from.max_rate;
    wanted.status_interval_s = from.status_interval_s;
    wanted.compressed = from.compressed != 0;
    wanted.sensors = from.sensors != 0;
    wanted.region_x = from.region_x;
    wanted.region_y = from.region_y;
    wanted.region_width = from.region_width;
    wanted.region_height = from.region_height;
    return wanted;
}

disparity_inertial_calibration in_c(const disparity::InertialCalibration& from) {
    disparity_inertial_calibration to{};
    to.calibration_id = from.calibration_id;
    if (from.pose) {
        to.holds |= DISPARITY_INERTIAL_POSE;
        std::copy(from.pose->rotation.begin(), from.pose->rotation.end(), to.rotation);
        std::copy(from.pose->translation_mm.begin(), from.pose->translation_mm.end(), to.translation_mm);
    }
    if (from.time_offset_s) {
        to.holds |= DISPARITY_INERTIAL_TIME_OFFSET;
        to.time_offset_s = *from.time_offset_s;
    }
    to.gyroscope_noise_density = from.gyroscope_noise_density.value_or(0);
    to.gyroscope_random_walk = from.gyroscope_random_walk.value_or(0);
    to.accelerometer_noise_density = from.accelerometer_noise_density.value_or(0);
    to.accelerometer_random_walk = from.accelerometer_random_walk.value_or(0);
    return to;
}

/// Of a disparity_socket or a disparity_client.
template <class AnyClient>
int read_sensors(AnyClient* client, disparity_sensor_sample* samples, size_t sample_bytes, size_t capacity,
                 size_t* count, int timeout_ms) {
    return guarded<int>(DISPARITY_ERROR, [&]() -> int {
        AnyClient& from = given(client, "client");
        auto* to = reinterpret_cast<unsigned char*>(&given(samples, "samples"));
        given(count, "count") = 0;
        if (sample_bytes == 0 || capacity == 0) {
            throw std::invalid_argument("samples have no room");
        }
        while (from.sensors_read == from.sensors.samples.size()) {
            from.sensors_read = 0;
            from.sensors.samples.clear();
            const int result = code(from.client.read_sensors(from.sensors, std::chrono::milliseconds(timeout_ms)),
                                    from.client.why_gone());
            if (result != DISPARITY_FRAME) {
                return result;
            }
        }
        for (; *count < capacity && from.sensors_read < from.sensors.samples.size(); ++*count, to += sample_bytes) {
            disparity_sensor_sample sample = in_c(from.sensors.samples[from.sensors_read]);
            sample.skipped = from.sensors_read == 0 ? static_cast<std::uint32_t>(from.sensors.skipped) : 0;
            ++from.sensors_read;
            std::memcpy(to, &sample, std::min(sample_bytes, sizeof sample));
        }
        return DISPARITY_FRAME;
    });
}

/// Of a disparity_socket or a disparity_client.
template <class AnyClient>
const void* read_status(AnyClient* client, int timeout_ms, size_t* bytes) {
    return guarded<const void*>(nullptr, [&] {
        AnyClient& from = given(client, "client");
        from.status = from.client.status(std::chrono::milliseconds(timeout_ms));
        given(bytes, "bytes") = from.status.size();
        return static_cast<const void*>(from.status.data());
    });
}

/// Keeps what `compute` makes of a frame in a member of it, and says its size. Returns nullptr when there is nothing.
template <class Result, class Compute>
const Result* computed(disparity_frame* frame, Result disparity_frame::*member, uint32_t* width, uint32_t* height,
                       Compute compute) {
    return guarded<const Result*>(nullptr, [&]() -> const Result* {
        auto result = std::visit(compute, given(frame, "frame").frame);
        if (!result) {
            error_text() =
                "the frame does not carry what this is computed from: subscribe to it, or calibrate the camera";
            return nullptr;
        }
        given(width, "width") = result->width;
        given(height, "height") = result->height;
        frame->*member = *std::move(result);
        return &(frame->*member);
    });
}

template <class Compute>
const float* image(disparity_frame* frame, disparity::FloatImage disparity_frame::*member, uint32_t* width,
                   uint32_t* height, Compute compute) {
    const disparity::FloatImage* found = computed(frame, member, width, height, compute);
    return found == nullptr ? nullptr : found->values.data();
}

disparity_scan_info in_c(const disparity::Scan& from) {
    disparity_scan_info to{};
    to.sectors = static_cast<std::uint32_t>(from.sectors.size());
    to.ground = static_cast<std::uint32_t>(from.ground);
    to.ground_age = from.ground_age;
    to.ground_height_m = static_cast<float>(from.ground_height_m);
    to.ground_slope_ahead = static_cast<float>(from.ground_slope_ahead);
    to.ground_slope_left = static_cast<float>(from.ground_slope_left);
    to.low_m = static_cast<float>(from.low_m);
    to.high_m = static_cast<float>(from.high_m);
    to.min_m = static_cast<float>(from.min_m);
    to.max_m = static_cast<float>(from.max_m);
    const disparity::Mounting mounting = from.mounting.value_or(disparity::Mounting{});
    to.mounting_height_m = static_cast<float>(mounting.height_m);
    to.mounting_pitch_deg = static_cast<float>(mounting.pitch_deg);
    to.mounting_roll_deg = static_cast<float>(mounting.roll_deg);
    return to;
}

disparity_scan_sector in_c(const disparity::ScanSector& from) {
    disparity_scan_sector to{};
    to.from_deg = static_cast<float>(from.from_deg);
    to.to_deg = static_cast<float>(from.to_deg);
    to.distance_m = static_cast<float>(from.distance_m);
    to.sigma_m = static_cast<float>(from.sigma_m);
    to.free_m = static_cast<float>(from.free_m);
    to.low_m = static_cast<float>(from.low_m);
    to.high_m = static_cast<float>(from.high_m);
    to.pixels = from.pixels;
    to.state = static_cast<std::uint32_t>(from.state);
    to.confidence = from.confidence;
    to.doubts = from.doubts;
    to.trust = from.trust;
    return to;
}

}  // namespace

const char* disparity_last_error(void) {
    return error_text().c_str();
}

disparity_frame* disparity_frame_new(void) {
    return guarded<disparity_frame*>(nullptr, [] { return new disparity_frame{}; });
}

void disparity_frame_free(disparity_frame* frame) {
    delete frame;
}

void disparity_frame_get_info(const disparity_frame* frame, disparity_frame_info* info, size_t info_bytes) {
    if (frame == nullptr || info == nullptr) {
        return;
    }
    disparity_frame_info all{};
    const auto fill = [&all](const auto& from) {
        disparityd::proto::copy_frame_fields(all, from);
        all.skipped = from.skipped;
        all.region_x = from.region_x;
        all.region_y = from.region_y;
        all.plane_count = static_cast<std::uint32_t>(from.planes.size());
    };
    std::visit(fill, frame->frame);
    std::memcpy(info, &all, std::min(info_bytes, sizeof all));
}

int disparity_frame_get_plane(const disparity_frame* frame, uint32_t product, disparity_plane* plane) {
    if (frame == nullptr) {
        return 0;
    }
    return std::visit(
        [&](const auto& has) { return describe(has.plane(static_cast<disparity::Product>(product)), plane); },
        frame->frame);
}

int disparity_frame_plane_at(const disparity_frame* frame, uint32_t index, disparity_plane* plane) {
    if (frame == nullptr) {
        return 0;
    }
    return std::visit(
        [&](const auto& has) { return index < has.planes.size() ? describe(&has.planes[index], plane) : 0; },
        frame->frame);
}

int disparity_frame_is_whole(const disparity_frame* frame) {
    if (frame == nullptr) {
        return 0;
    }
    const auto* borrowed = std::get_if<disparity::BorrowedFrame>(&frame->frame);
    return borrowed == nullptr || borrowed->whole() ? 1 : 0;
}

int disparity_frame_get_scan(const disparity_frame* frame, disparity_scan_info* info, size_t info_bytes,
                             disparity_scan_sector* sectors, size_t sector_bytes, size_t capacity) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        const auto scan = std::visit([](const auto& has) { return has.scan(); }, given(frame, "frame").frame);
        if (!scan) {
            return 0;
        }
        if (info != nullptr) {
            const disparity_scan_info all = in_c(*scan);
            std::memcpy(info, &all, std::min(info_bytes, sizeof all));
        }
        auto* to = reinterpret_cast<unsigned char*>(sectors);
        for (std::size_t i = 0; to != nullptr && i < std::min(capacity, scan->sectors.size()); ++i) {
            const disparity_scan_sector sector = in_c(scan->sectors[i]);
            std::memcpy(to + i * sector_bytes, &sector, std::min(sector_bytes, sizeof sector));
        }
        return 1;
    });
}

disparity_shared_memory* disparity_shared_memory_open(const char* name) {
    return guarded<disparity_shared_memory*>(nullptr, [name] {
        return new disparity_shared_memory{disparity::SharedMemoryReader(name == nullptr ? "default" : name), {}};
    });
}

disparity_shared_memory* disparity_shared_memory_open_with(const char* name, const char* owner, int may_be_absent) {
    return guarded<disparity_shared_memory*>(nullptr, [&] {
        const disparity::SharedMemoryOptions options{may_be_absent != 0, owner == nullptr ? "" : owner};
        return new disparity_shared_memory{disparity::SharedMemoryReader(name == nullptr ? "default" : name, options),
                                           {}};
    });
}

void disparity_shared_memory_close(disparity_shared_memory* reader) {
    delete reader;
}

int disparity_shared_memory_read(disparity_shared_memory* reader, disparity_frame* frame, int timeout_ms,
                                 const uint32_t* products, size_t count) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        auto& [shared, wanted] = given(reader, "reader");
        if (count != 0) {
            given(products, "products");
        }
        wanted.clear();
        for (size_t i = 0; i < count; ++i) {
            wanted.push_back(static_cast<disparity::Product>(products[i]));
        }
        return code(shared.read(as<disparity::Frame>(frame), std::chrono::milliseconds(timeout_ms), wanted),
                    shared.why_gone());
    });
}

int disparity_shared_memory_borrow(disparity_shared_memory* reader, disparity_frame* frame, int timeout_ms) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        disparity::SharedMemoryReader& shared = given(reader, "reader").reader;
        return code(shared.borrow(as<disparity::BorrowedFrame>(frame), std::chrono::milliseconds(timeout_ms)),
                    shared.why_gone());
    });
}

int64_t disparity_shared_memory_heartbeat_age_ns(const disparity_shared_memory* reader) {
    return reader == nullptr ? std::numeric_limits<int64_t>::max() : reader->reader.heartbeat_age().count();
}

disparity_socket* disparity_socket_open(const char* address, const char* client_name, int timeout_ms) {
    const disparity_connect_options none{};
    return disparity_socket_open_with(address, client_name, timeout_ms, &none, sizeof none);
}

disparity_socket* disparity_socket_open_with(const char* address, const char* client_name, int timeout_ms,
                                             const disparity_connect_options* options, size_t options_bytes) {
    return guarded<disparity_socket*>(nullptr, [&] {
        given(address, "address");
        disparity_connect_options from{};
        std::memcpy(&from, &given(options, "options"), std::min(options_bytes, sizeof from));
        const disparity::ConnectOptions to = in_cpp(from);
        return new disparity_socket{
            disparity::SocketClient(address, to, client_name == nullptr ? "disparity-client" : client_name,
                                    std::chrono::milliseconds(timeout_ms)),
            {},
            {}};
    });
}

void disparity_socket_close(disparity_socket* client) {
    delete client;
}

int disparity_socket_subscribe(disparity_socket* client, const disparity_subscription* subscription) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        given(client, "client").client.subscribe(in_cpp(given(subscription, "subscription")));
        return 0;
    });
}

int disparity_socket_read(disparity_socket* client, disparity_frame* frame, int timeout_ms) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        disparity::SocketClient& from = given(client, "client").client;
        return code(from.read(as<disparity::Frame>(frame), std::chrono::milliseconds(timeout_ms)), from.why_gone());
    });
}

int disparity_socket_read_sensors(disparity_socket* client, disparity_sensor_sample* samples, size_t sample_bytes,
                                  size_t capacity, size_t* count, int timeout_ms) {
    return read_sensors(client, samples, sample_bytes, capacity, count, timeout_ms);
}

const void* disparity_socket_status(disparity_socket* client, int timeout_ms, size_t* bytes) {
    return read_status(client, timeout_ms, bytes);
}

int disparity_inertial_calibration_of(const void* status, size_t bytes, disparity_inertial_calibration* calibration,
                                      size_t calibration_bytes) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        const auto* text = &given(static_cast<const char*>(status), "status");
        given(calibration, "calibration");
        const auto from = disparity::inertial_calibration(std::string(text, bytes));
        const disparity_inertial_calibration to = from ? in_c(*from) : disparity_inertial_calibration{};
        std::memcpy(calibration, &to, std::min(calibration_bytes, sizeof to));
        return from ? 1 : 0;
    });
}

disparity_client* disparity_connect(const char* where, const uint32_t* products, size_t count) {
    disparity_subscription wanted{};
    wanted.products = products;
    wanted.product_count = count;
    const disparity_client_options none{};
    return disparity_connect_with(where, &wanted, &none, sizeof none);
}

disparity_client* disparity_connect_with(const char* where, const disparity_subscription* wanted,
                                         const disparity_client_options* options, size_t options_bytes) {
    return guarded<disparity_client*>(nullptr, [&] {
        disparity_client_options from{};
        std::memcpy(&from, &given(options, "options"), std::min(options_bytes, sizeof from));
        disparity::ClientOptions to;
        to.may_be_absent = from.may_be_absent != 0;
        if (from.timeout_ms != 0) {
            to.timeout = std::chrono::milliseconds(from.timeout_ms);
        }
        if (from.client_name != nullptr) {
            to.client_name = from.client_name;
        }
        to.owner = text(from.owner);
        to.reach = in_cpp(from.reach);
        return new disparity_client{
            disparity::connect(text(where), in_cpp(given(wanted, "wanted")), to), {}, {}, 0, {}};
    });
}

void disparity_client_close(disparity_client* client) {
    delete client;
}

int disparity_client_subscribe(disparity_client* client, const disparity_subscription* wanted) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        given(client, "client").client.subscribe(in_cpp(given(wanted, "wanted")));
        return 0;
    });
}

int disparity_client_read(disparity_client* client, disparity_frame* frame, int timeout_ms) {
    return guarded<int>(DISPARITY_ERROR, [&] {
        disparity::Client& from = given(client, "client").client;
        return code(from.read(as<disparity::Frame>(frame), std::chrono::milliseconds(timeout_ms)), from.why_gone());
    });
}

int disparity_client_read_sensors(disparity_client* client, disparity_sensor_sample* samples, size_t sample_bytes,
                                  size_t capacity, size_t* count, int timeout_ms) {
    return read_sensors(client, samples, sample_bytes, capacity, count, timeout_ms);
}

const void* disparity_client_status(disparity_client* client, int timeout_ms, size_t* bytes) {
    return read_status(client, timeout_ms, bytes);
}

const char* disparity_client_where(disparity_client* client) {
    return guarded<const char*>("", [&] {
        disparity_client& of = given(client, "client");
        of.where = of.client.where();
        return of.where.c_str();
    });
}

const float* disparity_frame_disparity_px(disparity_frame* frame, uint32_t* width, uint32_t* height) {
    return image(frame, &disparity_frame::disparity_px, width, height,
                 [](const auto& of) { return of.disparity_px(); });
}

const float* disparity_frame_depth_m(disparity_frame* frame, uint32_t* width, uint32_t* height) {
    return image(frame, &disparity_frame::depth_m, width, height, [](const auto& of) { return of.depth_m(); });
}

const float* disparity_frame_depth_error_m(disparity_frame* frame, uint32_t* width, uint32_t* height) {
    return image(frame, &disparity_frame::depth_error_m, width, height,
                 [](const auto& of) { return of.depth_error_m(); });
}

const disparity_point* disparity_frame_points(disparity_frame* frame, uint32_t step, uint32_t* width,
                                              uint32_t* height) {
    const auto* points =
        computed(frame, &disparity_frame::points, width, height, [step](const auto& of) { return of.points(step); });
    // The same layout: static_assert above.
    return points == nullptr ? nullptr : reinterpret_cast<const disparity_point*>(points->points.data());
}
