// SPDX-License-Identifier: Apache-2.0
/// @file
/// C++ interface of the client library of disparityd.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "disparity_inertial.hpp"
#include "disparity_products.hpp"

/// The client library of disparityd reads frames over shared memory or a socket. It depends on nothing of the daemon.
/// All calls on one object come from one thread; different objects are independent.
namespace disparity {

/// Bits of Frame::flags.
enum FrameFlags : std::uint32_t {
    unrectified = 1,       ///< no calibration: the pixels are as captured
    interpolated = 2,      ///< rejected pixels were filled from their neighbours
    dropped_before = 4,    ///< Frame::dropped_before is not 0
    discontinuity = 8,     ///< the first frame after a gap or restart of the source
    synthetic = 16,        ///< rendered, or a recording of rendered frames: not from a camera
    exposure_centre = 32,  ///< the capture time was moved to the centre of the exposure
    // Doubts: why the frame can be trusted less.
    dark = 0x100,          ///< both eyes see hardly any light
    saturated = 0x200,     ///< much of a picture is white
    blurred = 0x400,       ///< one eye sees less sharply than the other
    dirty_eye = 0x800,     ///< a part of one eye stays dull where the other eye sees texture
    covered_eye = 0x1000,  ///< one eye sees nothing where the other sees texture
    misaligned = 0x2000,   ///< the rows of both eyes do not fit
    too_near = 0x4000,     ///< something may be nearer than can be measured
    noisy = 0x8000         ///< so much noise that the frame was matched for that
};

/// Returns the trust in a frame of these flags: 1 .. 255, more is better; 0 where the daemon does not tell it.
constexpr std::uint32_t trust_of(std::uint32_t flags) {
    return flags >> 24U;
}

/// Returns the doubts in a frame of these flags as words with spaces between them, such as "dirty-eye noisy"; "" where
/// there is none.
DISPARITY_API std::string doubt_names(std::uint32_t flags);

/// One plane of a frame: rows follow each other without gaps, little endian.
struct PlaneData {
    Product product{};                  ///< what the plane holds
    std::uint32_t width = 0;            ///< px
    std::uint32_t height = 0;           ///< px
    std::uint32_t bytes_per_pixel = 0;  ///< all channels together
    std::vector<std::uint8_t> bytes;    ///< width * height * bytes_per_pixel; the next read uses the buffer again
};

/// Everything that comes with a frame beside its planes.
struct FrameInfo {
    std::uint64_t publish_index = 0;  ///< counts what the daemon has published since its start, from 0, without gaps
    std::uint64_t sequence = 0;       ///< the source's own number of the frame; gaps where the source lost some
    std::int64_t monotonic_ns = 0;    ///< capture time, CLOCK_MONOTONIC of the daemon's machine
    std::int64_t realtime_ns = 0;     ///< capture time, CLOCK_REALTIME: ns since 1970
    /// From capture until read() or borrow() gave the frame: on its way and in buffers, too. Of a daemon on another
    /// machine it may be more, by no more than the shortest way there that was seen; it is never less.
    std::int64_t age_ns = 0;
    std::uint64_t dropped_before = 0;  ///< frames that never were published since the one before: lost or dropped
    std::uint64_t skipped = 0;         ///< frames published but not seen by this client, since the one read before
    std::uint64_t calibration_id = 0;  ///< changes when the calibration does; 0 = none
    double f = 0;                      ///< focal length of the rectified camera, px; 0 = unknown
    double cx = 0;                     ///< column of the principal point of the rectified camera, px
    double cy = 0;                     ///< row of the principal point of the rectified camera, px
    double baseline_mm = 0;            ///< distance of the two cameras, mm; 0 = unknown
    double disparity_offset = 0;       ///< px; is added to a valid disparity before depth is computed from it
    std::int32_t d_min = 0;            ///< the first candidate, px
    std::uint32_t disparities = 0;     ///< the number of candidates, the last one is d_min + disparities - 1
    std::int32_t invalid = 0;          ///< the disparity of a rejected pixel, 1/16 px: (d_min - 1) * 16
    std::uint32_t flags = 0;           ///< FrameFlags, and what trust_of() returns
    std::uint32_t width = 0;           ///< of the whole rectified image, px
    std::uint32_t height = 0;          ///< of the whole rectified image, px
    std::uint32_t region_x = 0;        ///< the column of the whole image where the planes begin
    std::uint32_t region_y = 0;        ///< the row of the whole image where the planes begin
    std::int64_t sent_age_ns = 0;      ///< part of age_ns: from capture until the daemon published or sent the frame
};

/// Returns the distance along the optical axis of a disparity in px, Z = f B / (d + disparity_offset), in m; nothing
/// where it has none: without a calibration, and where d + disparity_offset is not above 0.
DISPARITY_API std::optional<double> distance_m(const FrameInfo& frame, double disparity_px);

/// A number for each pixel, row by row.
struct FloatImage {
    std::uint32_t width = 0;    ///< px
    std::uint32_t height = 0;   ///< px
    std::vector<float> values;  ///< width * height
};

/// A point in the axes of the rectified left camera: x right, y down, z ahead; all NaN where the depth is unknown or
/// beyond what can be measured.
struct Point {
    float x = 0;              ///< m
    float y = 0;              ///< m
    float z = 0;              ///< m
    std::uint8_t red = 0;     ///< of the left image, as green and blue; 0 where Points::coloured is false
    std::uint8_t green = 0;   ///< see red
    std::uint8_t blue = 0;    ///< see red
    std::uint8_t unused = 0;  ///< 0
};

/// A point for each pixel, row by row, so that neighbours are neighbours in the image.
struct Points {
    std::uint32_t width = 0;    ///< points in a row
    std::uint32_t height = 0;   ///< rows
    bool coloured = false;      ///< the frame carries Product::left_colour, or Product::left (then red = green = blue)
    std::vector<Point> points;  ///< width * height
};

/// What a sector of an obstacle scan shows.
enum class SectorState : std::uint8_t {
    unknown = 0,   ///< as good as nothing is known: it may hold an obstacle at any distance
    free = 1,      ///< no obstacle up to ScanSector::free_m; what lies beyond is unknown
    occupied = 2,  ///< the nearest obstacle is at ScanSector::distance_m
    masked = 3     ///< unknown, because the robot's own parts hide all of it
};

/// One sector of an obstacle scan. Distances are horizontal, from the robot's origin.
struct ScanSector {
    double from_deg = 0;                       ///< bearing of the right edge; 0 is the robot's x axis, left is positive
    double to_deg = 0;                         ///< bearing of the left edge
    SectorState state = SectorState::unknown;  ///< a program that knows no other value takes it for unknown
    double distance_m = 0;                     ///< of an occupied sector: to the nearest obstacle
    double sigma_m = 0;                        ///< one-sigma error of distance_m
    /// No obstacle is nearer than this, whatever the state. Of an occupied sector it is at most distance_m, and less
    /// where something may hide in front of the obstacle.
    double free_m = 0;
    double low_m = 0;             ///< of the obstacle, its lowest part above the ground's plane
    double high_m = 0;            ///< its highest part
    std::uint32_t pixels = 0;     ///< that show the obstacle; 65535 = so many or more, 0 where is_near()
    std::uint8_t confidence = 0;  ///< mean of those pixels, as Product::confidence
    std::uint8_t trust = 0;       ///< how far the sector can be trusted: 1 .. 255, more is better; 0: not told
    std::uint32_t doubts = 0;     ///< why it can be trusted less: bits of FrameFlags, see doubt_names()

    /// Returns whether the obstacle is nearer than can be measured: distance_m is the most that it can be.
    bool is_near() const { return state == SectorState::occupied && pixels == 0; }
};

/// Where the ground's plane of a scan comes from. A later daemon may send other numbers: the plane holds all the same.
enum class GroundSource : std::uint8_t {
    configured = 0,  ///< the plane z = 0 of the configured mounting
    fitted = 1,      ///< fitted to this frame
    held = 2,        ///< fitted to an earlier frame, Scan::ground_age frames ago
    gravity = 3,     ///< level, as the camera's inertial sensor says
    autopilot = 4    ///< level, as an autopilot says
};

/// How the left camera is mounted above the floor, as the floor in view shows: what the daemon's configuration calls
/// camera_height_m, pitch_deg and roll_deg.
struct Mounting {
    double height_m = 0;   ///< of the camera above the floor
    double pitch_deg = 0;  ///< positive looks down
    double roll_deg = 0;   ///< positive has its right side lower
};

/// An obstacle scan: by bearing, what is near. The frame of reference is the robot's: x ahead, y left, z up, the origin
/// on the ground below the camera, or where the daemon's configuration puts it.
struct Scan {
    GroundSource ground = GroundSource::configured;  ///< where the plane comes from
    std::uint32_t ground_age = 0;                    ///< frames since it was fitted
    double ground_height_m = 0;                      ///< the plane is z = ground_height_m + ground_slope_ahead x
    double ground_slope_ahead = 0;                   ///< + ground_slope_left y
    double ground_slope_left = 0;                    ///< see ground_slope_ahead
    double low_m = 0;                                ///< obstacles lie between these heights above the plane
    double high_m = 0;                               ///< the upper one
    double min_m = 0;                                ///< nothing nearer is reported
    double max_m = 0;                                ///< nothing beyond is reported
    std::optional<Mounting> mounting;                ///< that the last seconds' floor shows; nothing: not found
    std::vector<ScanSector> sectors;                 ///< by bearing, the right-most first
};

/// A frame that was copied.
struct DISPARITY_API Frame : FrameInfo {
    std::vector<PlaneData> planes;  ///< one for each product that the frame carries

    /// Returns the plane of a product, or nullptr when the frame does not carry it.
    const PlaneData* plane(Product product) const;

    /// Returns the obstacle scan, or nothing when the frame does not carry one. Throws std::runtime_error for one of
    /// another version.
    std::optional<Scan> scan() const;

    /// Returns the disparities in px, NaN where rejected; nothing when the frame does not carry them.
    std::optional<FloatImage> disparity_px() const;

    /// Returns the depths in m: NaN where unknown, +infinity where beyond what can be measured (beyond 65.534 m of
    /// Product::depth). They come from Product::depth, else from the disparities; nothing when the frame carries
    /// neither, or only disparities without a calibration.
    std::optional<FloatImage> depth_m() const;

    /// Returns one sigma of depth in m: NaN where unknown, +infinity from 65.535 m; nothing without
    /// Product::depth_error.
    std::optional<FloatImage> depth_error_m() const;

    /// Returns the nearest point of each block of `step` columns and rows (0 counts as 1), so that nothing thin is
    /// lost. They come from the disparities, which are finer than a millimetre near the camera, else from
    /// Product::depth; nothing when the frame carries neither or has no calibration.
    std::optional<Points> points(std::uint32_t step = 1) const;
};

/// Bytes in memory that belongs to somebody else.
class BorrowedBytes {
public:
    /// None.
    BorrowedBytes() = default;
    /// `size` bytes from `data` on.
    BorrowedBytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

    const std::uint8_t* data() const { return data_; }                 ///< the first one
    std::size_t size() const { return size_; }                         ///< how many there are
    const std::uint8_t* begin() const { return data_; }                ///< the first one
    const std::uint8_t* end() const { return data_ + size_; }          ///< behind the last one
    std::uint8_t operator[](std::size_t i) const { return data_[i]; }  ///< byte i, below size()

private:
    const std::uint8_t* data_ = nullptr;
    std::size_t size_ = 0;
};

/// One plane of a borrowed frame: rows follow each other without gaps, little endian.
struct BorrowedPlane {
    Product product{};                  ///< what the plane holds
    std::uint32_t width = 0;            ///< px
    std::uint32_t height = 0;           ///< px
    std::uint32_t bytes_per_pixel = 0;  ///< all channels together
    /// width * height * bytes_per_pixel, in the shared memory: read-only, mapped as long as the frame is.
    BorrowedBytes bytes;
};

/// A frame where it lies in the shared memory; its planes are not copied. The daemon never waits: the frame stays for
/// one frame less than the ring has slots ([shared_memory] slots), then the daemon writes another one over it. So
/// compute from the planes, then ask whole(), and use the result only if it is. The memory stays mapped until the
/// object borrows again or ends, even after its reader or the daemon has.
class DISPARITY_API BorrowedFrame : public FrameInfo {
public:
    /// Holds no frame.
    BorrowedFrame();
    ~BorrowedFrame();
    /// One that was moved from may only be assigned to or destroyed.
    BorrowedFrame(BorrowedFrame&&) noexcept;
    /// As the constructor that moves.
    BorrowedFrame& operator=(BorrowedFrame&&) noexcept;

    /// Returns whether all that was read from the planes until now belongs to this frame. Once it is false it stays so.
    /// False for an object that holds no frame. Any thread may ask.
    bool whole() const;

    /// Returns the plane of a product, or nullptr when the frame does not carry it.
    const BorrowedPlane* plane(Product product) const;

    /// As those of Frame. Ask whole() afterwards.
    std::optional<Scan> scan() const;
    std::optional<FloatImage> disparity_px() const;              ///< see scan()
    std::optional<FloatImage> depth_m() const;                   ///< see scan()
    std::optional<FloatImage> depth_error_m() const;             ///< see scan()
    std::optional<Points> points(std::uint32_t step = 1) const;  ///< see scan()

    std::vector<BorrowedPlane> planes;  ///< all that the daemon serves

private:
    friend class SharedMemoryReader;
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// What reading returns.
enum class ReadResult {
    frame,    ///< a frame newer than the one read before
    timeout,  ///< nothing new came in time; the daemon lives
    gone,     ///< there is no daemon: it has stopped or died. Later reads look for it again
};

/// Says what a reader of the shared memory does without a daemon, and which owner of the object it trusts.
struct SharedMemoryOptions {
    /// Without a daemon the constructor does not throw; read() waits for one.
    bool may_be_absent = false;
    /// The user whose object is trusted, beside root's and those of this program's own user: a name or a number.
    /// Empty: the user that the environment variable DISPARITYD_SHARED_MEMORY_OWNER names, else "disparityd".
    std::string owner{};
};

/// Reads frames from shared memory. The writer never waits for a reader. A reader uses an object only when its owner is
/// trusted (SharedMemoryOptions::owner) and nobody else can write it.
class DISPARITY_API SharedMemoryReader {
public:
    /// Maps /disparityd.NAME read-only. Throws std::invalid_argument for a name that is not allowed. Throws
    /// std::runtime_error with one line (what, where, what to do) when the object has another version, and, unless it
    /// may be absent, when there is none, access is denied or its owner is not trusted.
    explicit SharedMemoryReader(const std::string& name = "default");
    /// The same with options.
    SharedMemoryReader(const std::string& name, const SharedMemoryOptions& options);
    ~SharedMemoryReader();
    /// A reader that was moved from may only be assigned to or destroyed.
    SharedMemoryReader(SharedMemoryReader&&) noexcept;
    /// As the constructor that moves.
    SharedMemoryReader& operator=(SharedMemoryReader&&) noexcept;

    /// Copies the newest frame that was not read before; waits for one until the timeout. After a reload of the daemon
    /// it maps the new object. Returns `gone` at once when the daemon stops, and within 3 s when it dies. The calls
    /// after it wait for a new daemon under the name, and return `gone` again when none has come in time: a program
    /// that keeps reading survives a restart of the daemon. Only the wanted products are copied (empty = all). `frame`
    /// is valid only when the result is ReadResult::frame. Throws std::runtime_error when a new object of a trusted
    /// user cannot be used.
    ReadResult read(Frame& frame, std::chrono::milliseconds timeout, const std::vector<Product>& wanted = {});

    /// The same without a copy of the planes: `frame` then shows where they lie, and gives up what it held before. Its
    /// time does not depend on the size of the image.
    ReadResult borrow(BorrowedFrame& frame, std::chrono::milliseconds timeout);

    /// Returns one line: why the last read() or borrow() was `gone`.
    const std::string& why_gone() const;

    /// Returns the age of the daemon's last heartbeat; the largest value after `gone`.
    std::chrono::nanoseconds heartbeat_age() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// Says what the daemon sends to a client.
struct Subscription {
    std::vector<Product> products{Product::disparity};  ///< empty = no frames
    double max_rate = 0;                                ///< frames per second, 0 = all
    bool compressed = false;                            ///< planes are sent with zstd; read() unpacks them
    std::uint32_t region_x = 0;                         ///< column of the rectified image where the region begins
    std::uint32_t region_y = 0;                         ///< row of the rectified image where the region begins
    std::uint32_t region_width = 0;                     ///< px; 0 = the whole image
    std::uint32_t region_height = 0;                    ///< px
    double status_interval_s = 0;                       ///< for SocketClient::take_status(); 0 = no status messages
    bool sensors = false;                               ///< for SocketClient::read_sensors()
};

/// Has the axes of the camera's sensor, as it sends them: nothing is rotated or calibrated.
struct SensorVector {
    float x = 0;  ///< in the unit of the field
    float y = 0;  ///< in the unit of the field
    float z = 0;  ///< in the unit of the field
};

/// What the inertial sensor measured.
struct Inertial {
    SensorVector angular_velocity;  ///< rad/s
    SensorVector acceleration;      ///< m/s², gravity included
    float celsius = 0;              ///< of the inertial sensor
};

/// What was measured inside the camera.
struct Environment {
    float celsius = 0;           ///< inside the camera
    float hectopascal = 0;       ///< pressure of the air
    float humidity_percent = 0;  ///< relative
};

/// What the image sensors' thermometers measured.
struct EyeTemperatures {
    float left_celsius = 0;   ///< of the left one
    float right_celsius = 0;  ///< of the right one
};

/// What the camera's sensors measured at one instant; what is absent was not measured.
struct SensorSample {
    std::int64_t monotonic_ns = 0;     ///< of that instant, the daemon's CLOCK_MONOTONIC; of a replay, as recorded
    std::int64_t realtime_ns = 0;      ///< of that instant, CLOCK_REALTIME: ns since 1970
    std::int64_t camera_ns = 0;        ///< on the camera's clock, which starts at any value
    std::uint32_t lost_before = 0;     ///< samples that the daemon lost since the one before
    bool frame_sync = false;           ///< measured at the instant of a frame's exposure
    std::uint32_t frame_syncs = 0;     ///< the camera's count of such instants
    std::optional<Inertial> inertial;  ///< motion
    std::optional<SensorVector> magnetic_field;       ///< microtesla
    std::optional<Environment> environment;           ///< temperature and air inside the camera
    std::optional<EyeTemperatures> eye_temperatures;  ///< temperatures of the image sensors
};

/// What SocketClient::read_sensors() gives.
struct SensorBatch {
    std::vector<SensorSample> samples;  ///< in order
    std::uint64_t skipped = 0;          ///< samples not given to this client before them, because it read too slowly
    std::int64_t age_ns = 0;            ///< of the last one when it was sent
};

/// Where up was at one instant, along the robot's axes; of length 1.
struct Level {
    double ahead = 0;                  ///< the part of the direction along the axis that points ahead
    double left = 0;                   ///< along the axis to the left
    double up = 1;                     ///< along the axis upwards
    std::chrono::microseconds age{0};  ///< when it is given; at most a second
};

/// Says how a client and a daemon beyond this machine know each other. The files are read whenever a connection is
/// made, so that new ones take effect at the next one.
struct ConnectOptions {
    /// File of the authorities (PEM), one of which must have signed the daemon's certificate. Empty: those that the
    /// system trusts. For "tls:HOST:PORT", as the next three.
    std::string authority{};
    std::string certificate{};  ///< file of this client's own certificate, with its chain (PEM); empty: none
    std::string key{};          ///< file of that certificate's key (PEM, not encrypted)
    std::string server_name{};  ///< name or address in the daemon's certificate; empty: HOST of the address
    /// File with the token that the daemon asks for ([socket] tokens): a line "TOKEN", or as in the daemon's file. It
    /// must not be readable by every user. Empty: none.
    std::string token_file{};
    std::string token{};  ///< the token itself, for a program that has it from elsewhere; goes before token_file
};

/// Reads frames and status from a socket: "unix:PATH", "tcp:HOST:PORT" or, encrypted, "tls:HOST:PORT". "//" may follow
/// the colon.
///
/// The newest frame counts: the daemon sends one when the program is ready for it, so that no frame grows old on the
/// way or in a buffer, however long the program works on each. FrameInfo::age_ns counts until the program has the
/// frame.
///
/// Over "tls:" the daemon's certificate is always checked: that an authority which is trusted has signed it, that it is
/// for this host, and that it is valid now. A token is sent over "tls:", and over "tcp:" only to this machine.
///
/// When the connection ends, the first read() or read_sensors() after it returns `gone`. The calls after that connect
/// again, send Hello and subscribe as before. They return `gone` again when no daemon answers until the timeout, which
/// must be longer than a message needs to the daemon and back. A program that keeps reading survives a restart of the
/// daemon. Requests connect again, too. A daemon that says nothing is asked whether it is there, after half a second or
/// three frames' time; when it does not answer within a second, as over a link that was cut, that is `gone`, too.
///
/// An object that two threads use at once, or two processes after fork(), throws std::invalid_argument.
class DISPARITY_API SocketClient {
public:
    /// Connects and sends Hello. Throws std::invalid_argument for an address of another form, std::runtime_error with
    /// one line when connecting fails or the daemon refuses.
    explicit SocketClient(const std::string& address, const std::string& client_name = "disparity-client",
                          std::chrono::milliseconds timeout = std::chrono::seconds(5));
    /// The same with options. Also throws std::invalid_argument for a file that cannot be used, and for a token that
    /// would be sent unencrypted to another machine.
    SocketClient(const std::string& address, const ConnectOptions& options,
                 const std::string& client_name = "disparity-client",
                 std::chrono::milliseconds timeout = std::chrono::seconds(5));
    ~SocketClient();
    /// A client that was moved from may only be assigned to or destroyed.
    SocketClient(SocketClient&&) noexcept;
    /// As the constructor that moves.
    SocketClient& operator=(SocketClient&&) noexcept;

    /// Returns the daemon's answer to the last Hello: a serialized disparityd.v1.Welcome (geometry, products, name of
    /// shared memory).
    const std::string& welcome() const;

    /// Returns the user id of the process that listens at a Unix socket, as the system knows it; nothing over TCP. A
    /// program that connects to a socket in a folder that others may write to compares it with the user that it trusts.
    std::optional<unsigned> server_user() const;

    /// Replaces the subscription. Frames of the one before may still arrive; the next read() throws when the daemon
    /// refuses. When the connection has ended, the subscription holds from the next one on.
    void subscribe(const Subscription& subscription);

    /// Gives the newest frame that was not given before, or waits for one. Whatever came while the program did
    /// something else is looked through: a frame that has lain for more than an interval is left out, counts as
    /// `skipped`, and the daemon is asked for a fresh one; that may take a little longer than the timeout. A program
    /// that waits here gets every frame as it is published. Returns `gone` when the connection has ended: see above.
    /// Throws std::runtime_error with the daemon's message when it refuses or closes with an error, when it refuses the
    /// new connection until the timeout, or when it sends no valid frame; read() may be called again. `frame` is valid
    /// only when the result is ReadResult::frame.
    ReadResult read(Frame& frame, std::chrono::milliseconds timeout);

    /// Returns one line: why the last read() or read_sensors() was `gone`.
    const std::string& why_gone() const;

    /// Returns whether the daemon, or the link to it, did not answer when the last read() or read_sensors() was `gone`;
    /// false where the connection was closed, as by a daemon that stops.
    bool unanswered() const;

    /// Waits for samples of the camera's sensors (Subscription::sensors). Samples that came during other calls come
    /// first; the newest 8192 of them are kept. The newest frame that comes meanwhile is kept for read(). Returns
    /// and throws as read(), with ReadResult::frame for samples.
    ReadResult read_sensors(SensorBatch& batch, std::chrono::milliseconds timeout);

    /// Asks for the daemon's status and returns a serialized disparityd.v1.Status of proto/. The newest frame that
    /// arrives meanwhile is kept for read(). This and the requests below throw std::runtime_error when the daemon
    /// refuses (with its message), no answer comes in time, or the connection has ended.
    std::string status(std::chrono::milliseconds timeout);

    /// Returns the newest status message that came unasked (Subscription::status_interval_s) during any call since the
    /// last take_status(); empty when none did.
    std::string take_status();

    /// Starts a recording on the daemon's machine and returns a serialized disparityd.v1.RecordStatus. `path` is
    /// relative to the daemon's folder for recordings, is new and ends in .mkv.
    std::string start_recording(const std::string& path, std::chrono::milliseconds timeout);
    /// Stops the recording that runs, and returns the same.
    std::string stop_recording(std::chrono::milliseconds timeout);

    /// Sets controls of the daemon's live camera, in this order (none: only asks), and returns a serialized
    /// disparityd.v1.CameraControls.
    std::string control_camera(const std::vector<std::pair<std::string, std::int64_t>>& settings,
                               std::chrono::milliseconds timeout);

    /// Tells the daemon where up was in the last moments, at most 64 of them in the order of time, for obstacle scans
    /// with [scan] ground = "autopilot". Returns a serialized disparityd.v1.LevelStatus.
    std::string give_level(const std::vector<Level>& levels, std::chrono::milliseconds timeout);

    /// Has the daemon record what its threads do in the next `seconds` (0.1 to 10), waits for that and returns a
    /// serialized disparityd.v1.Trace. `timeout` counts from the end of that time.
    std::string trace(double seconds, std::chrono::milliseconds timeout);

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// What connect() is told beside the daemon and what is wanted of it.
struct ClientOptions {
    /// Without a daemon connect() does not throw; read() waits for one.
    bool may_be_absent = false;
    std::string client_name = "disparity-client";                 ///< of this program, in the daemon's status
    std::chrono::milliseconds timeout = std::chrono::seconds(5);  ///< for a socket to answer connect()
    ConnectOptions reach{};                                       ///< certificates and the token
    std::string owner{};                                          ///< as SharedMemoryOptions::owner
    std::function<void(const std::string&)> note{};  ///< gets one line for each socket of another user left alone
};

/// A daemon as a program sees it: frames over shared memory where there is one, else over a socket, and beside them the
/// sensors and the status, always over a socket. connect() makes it.
///
/// The newest frame counts, and a restart of the daemon is survived: the read that finds it gone says so, and those
/// after it look for it again, by its name and in both ways. Frames that came over the socket of a daemon go on over
/// its shared memory as soon as that can be read.
///
/// One thread uses an object at a time, and the process that made it: else std::invalid_argument is thrown.
class DISPARITY_API Client {
public:
    /// As connect().
    explicit Client(const std::string& where, const Subscription& wanted = {}, const ClientOptions& options = {});
    ~Client();
    /// A client that was moved from may only be assigned to or destroyed.
    Client(Client&&) noexcept;
    /// As the constructor that moves.
    Client& operator=(Client&&) noexcept;

    /// Replaces what is wanted. A region is cut by the daemon, so such frames come over the socket. Throws
    /// std::invalid_argument for a status_interval_s, which status() makes needless.
    void subscribe(const Subscription& wanted);

    /// Gives the newest frame that was not given before, or waits for one until the timeout; a little longer where a
    /// daemon is being connected to, up to a second more. The first one out of shared memory may be an old one: see its
    /// age. `gone`: there is no daemon; the calls after the first `gone` look for it until their timeout. Throws
    /// std::runtime_error with the daemon's message when it refuses, as it does over the socket with a product that it
    /// does not make; a frame out of shared memory lacks that plane. read() may be called again, and then begins anew.
    ReadResult read(Frame& frame, std::chrono::milliseconds timeout);

    /// As SocketClient::read_sensors(), where Subscription::sensors was wanted.
    ReadResult read_sensors(SensorBatch& batch, std::chrono::milliseconds timeout);

    /// As SocketClient::status().
    std::string status(std::chrono::milliseconds timeout = std::chrono::seconds(5));

    /// Returns the connection for all other requests; makes it where there is none. It stays this object's: another
    /// call of it may end it, and subscribe() replaces what it has subscribed to. Throws std::runtime_error when no
    /// daemon answers.
    SocketClient& socket();

    /// Returns where frames come from now, for people: "shared memory default", "tcp:HOST:PORT", "unix:PATH"; empty
    /// while there is no daemon.
    std::string where() const;
    /// Returns one line: why the last read() or read_sensors() was `gone`.
    const std::string& why_gone() const;
    /// As SocketClient::unanswered().
    bool unanswered() const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// Connects to a daemon and says what is wanted of it. Every form of `where` leads to the same object:
///   "default", or another name     the daemon of this machine that has it (disparityd --name): its shared memory, else
///                                  the sockets where it listens by default
///   ""                             the daemon of this machine: that of the name "default", else the only one that runs
///   "unix:PATH", "/PATH", "tcp:HOST:PORT", "tls:HOST:PORT"     a socket, as SocketClient
/// Over shared memory it reads an object of a trusted owner alone; in a folder that other users may write to it
/// connects to sockets of this user and root alone.
///
/// Throws std::invalid_argument for another form, std::runtime_error with one line where none answers (unless it may be
/// absent), or where several run and none was named: the line names them.
DISPARITY_API Client connect(const std::string& where = "", const Subscription& wanted = {},
                             const ClientOptions& options = {});

}  // namespace disparity
