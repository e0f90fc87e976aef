// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#define DISPARITY_API __attribute__((visibility("default")))

/// Client library of disparityd: frames over shared memory or a socket. Depends on nothing of the daemon.
/// All calls on one object come from one thread; different objects are independent.
namespace disparity {

enum class Product : std::uint32_t { disparity = 1, confidence = 2, depth = 3, left = 4, left_colour = 5 };

enum FrameFlags : std::uint32_t { unrectified = 1, interpolated = 2, dropped_before = 4, discontinuity = 8 };

struct PlaneData {
    Product product{};
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t bytes_per_pixel = 0;
    std::vector<std::uint8_t> bytes;  ///< dense, little endian; the buffer is used again by the next read
};

/// Everything that comes with a frame; units as in docs/protocol.md.
struct DISPARITY_API Frame {
    std::uint64_t publish_index = 0;
    std::uint64_t sequence = 0;
    std::int64_t monotonic_ns = 0;
    std::int64_t realtime_ns = 0;
    std::int64_t age_ns = 0;
    std::uint64_t dropped_before = 0;  ///< lost before the daemon published
    std::uint64_t missed = 0;          ///< published, but not seen by this client, since the frame read before
    std::uint64_t calibration_id = 0;
    double f = 0, cx = 0, cy = 0, baseline_mm = 0, disparity_offset = 0;
    std::int32_t d_min = 0;
    std::uint32_t disparities = 0;
    std::int32_t invalid = 0;
    std::uint32_t flags = 0;
    std::uint32_t width = 0;  ///< of the whole rectified image
    std::uint32_t height = 0;
    std::uint32_t region_x = 0, region_y = 0;  ///< where the planes start in it
    std::vector<PlaneData> planes;

    /// The plane of a product, or nullptr when the frame does not carry it.
    const PlaneData* plane(Product product) const;
};

enum class ReadResult {
    frame,    ///< a frame newer than the one read before
    timeout,  ///< nothing new in time; the daemon lives
    gone,     ///< the daemon has stopped or died: try to connect again
};

/// Reads frames from shared memory. The writer never waits for a reader.
class DISPARITY_API SharedMemoryReader {
public:
    /// Maps /disparityd.<name> read-only. Throws std::invalid_argument for a name that is not allowed,
    /// std::runtime_error with one line (what, where, what to do) when there is none, access is denied, or its version
    /// is not ours.
    explicit SharedMemoryReader(const std::string& name = "default");
    ~SharedMemoryReader();
    SharedMemoryReader(SharedMemoryReader&&) noexcept;
    SharedMemoryReader& operator=(SharedMemoryReader&&) noexcept;

    /// Copies the newest frame that was not read before; waits for one until the timeout. After a reload of the daemon
    /// it maps the new object by itself; after `gone` each call looks for a new daemon under the name. Only the wanted
    /// products are copied (empty = all there are). What is in `frame` counts only when the result is
    /// ReadResult::frame. Throws std::runtime_error when a new object cannot be used.
    ReadResult read(Frame& frame, std::chrono::milliseconds timeout, const std::vector<Product>& wanted = {});

    /// Age of the daemon's last sign of life; the largest value after `gone`.
    std::chrono::nanoseconds heartbeat_age() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

struct Subscription {
    std::vector<Product> products{Product::disparity};
    double max_rate = 0;  ///< frames per second, 0 = all
    bool compressed = false;
    std::uint32_t region_x = 0, region_y = 0, region_width = 0, region_height = 0;  ///< width 0 = whole image
    double status_interval_s = 0;
    bool sensors = false;  ///< for SocketClient::read_sensors()
};

/// Along the axes of the camera's sensor, as it sends them: nothing is rotated or calibrated.
struct SensorVector {
    float x = 0, y = 0, z = 0;
};

struct Inertial {
    SensorVector angular_velocity;  ///< rad/s
    SensorVector acceleration;      ///< m/s², gravity included
    float celsius = 0;              ///< of the inertial sensor
};

struct Environment {
    float celsius = 0;           ///< inside the camera
    float hectopascal = 0;       ///< pressure of the air
    float humidity_percent = 0;  ///< relative
};

/// Of the image sensors.
struct EyeTemperatures {
    float left_celsius = 0, right_celsius = 0;
};

/// What the camera's sensors measured at one instant; what is absent was not measured.
struct SensorSample {
    std::int64_t monotonic_ns = 0;  ///< of that instant, the daemon's CLOCK_MONOTONIC; of a replay, as recorded
    std::int64_t realtime_ns = 0;
    std::int64_t camera_ns = 0;     ///< on the camera's clock, which starts anywhere
    std::uint32_t lost_before = 0;  ///< samples that the daemon lost since the one before
    bool frame_sync = false;        ///< measured at the instant of a frame's exposure
    std::uint32_t frame_syncs = 0;  ///< the camera's count of such instants
    std::optional<Inertial> inertial;
    std::optional<SensorVector> magnetic_field;  ///< microtesla
    std::optional<Environment> environment;
    std::optional<EyeTemperatures> eye_temperatures;
};

struct SensorBatch {
    std::vector<SensorSample> samples;  ///< in order
    std::uint64_t skipped = 0;          ///< samples that this client missed before them, because it read too slowly
    std::int64_t age_ns = 0;            ///< of the last one when it was sent
};

/// Reads frames and status from a socket: "tcp:HOST:PORT" or "unix:PATH".
class DISPARITY_API SocketClient {
public:
    /// Connects, says hello. Throws std::invalid_argument for an address that is none, std::runtime_error with one line
    /// when connecting fails or the daemon refuses.
    explicit SocketClient(const std::string& address, const std::string& client_name = "disparity-client",
                          std::chrono::milliseconds timeout = std::chrono::seconds(5));
    ~SocketClient();
    SocketClient(SocketClient&&) noexcept;
    SocketClient& operator=(SocketClient&&) noexcept;

    /// The daemon's answer to hello: a serialized disparityd.v1.Welcome (geometry, products, name of shared memory).
    const std::string& welcome() const;

    /// Replaces the subscription. Frames of the one before may still arrive; a refusal comes out of the next read().
    /// Throws std::runtime_error when the connection has ended.
    void subscribe(const Subscription& subscription);

    /// Waits for the next frame (older ones waiting in the socket are delivered first, none is skipped here).
    /// `gone` when the connection has ended: make a new client. Throws std::runtime_error with the daemon's message
    /// when it refuses or closes with an error, or when what it sends is no valid frame. What is in `frame` counts only
    /// when the result is ReadResult::frame.
    ReadResult read(Frame& frame, std::chrono::milliseconds timeout);

    /// Waits for samples of the camera's sensors (Subscription::sensors): those that came while frames or answers were
    /// waited for first, up to 8192 of which are kept, the newest win. Of the frames that come meanwhile up to 8 are
    /// kept for read(). Returns and throws as read(), with ReadResult::frame for samples.
    ReadResult read_sensors(SensorBatch& batch, std::chrono::milliseconds timeout);

    /// Asks for the daemon's status; the answer is the serialized disparityd.v1.Status message of proto/. Up to 8
    /// frames that arrive meanwhile are kept for read(), the newest win. This and the questions below throw
    /// std::runtime_error when the daemon refuses (in its words), no answer comes in time, or the connection has ended.
    std::string status(std::chrono::milliseconds timeout);

    /// The newest status message that came by itself (Subscription::status_interval_s) during any call since the last
    /// one of this; empty when none did.
    std::string take_status();

    /// Starts or stops a recording on the daemon's machine; the answer is a serialized disparityd.v1.RecordStatus.
    std::string start_recording(const std::string& path, std::chrono::milliseconds timeout);
    std::string stop_recording(std::chrono::milliseconds timeout);

    /// Sets controls of the daemon's live camera, in this order (none: only asks); the answer is a serialized
    /// disparityd.v1.CameraControls.
    std::string control_camera(const std::vector<std::pair<std::string, std::int64_t>>& settings,
                               std::chrono::milliseconds timeout);

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparity
