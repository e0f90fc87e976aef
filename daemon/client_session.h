// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "daemon/frame_compressor.h"
#include "daemon/frame_ring.h"
#include "daemon/log.h"
#include "daemon/published_frame.h"
#include "daemon/sensor_ring.h"

namespace disparityd {

/// Lines about clients, each kind limited for itself, so that a flood of one does not hide another.
struct ClientLog {
    LogLimiter came_and_went;
    LogLimiter broke_the_protocol;
    LogLimiter fell_behind;
};

/// What a session asks of the server that owns it; all calls in the server's thread.
class SessionHost {
public:
    /// The answer to a request about recordings: the state, or why it was refused.
    using RecordAnswer = std::function<void(const v1::RecordStatus& status, const std::string& refusal)>;

    /// The same for requests about the camera.
    using CameraAnswer = std::function<void(const v1::CameraControls& controls, const std::string& refusal)>;

    virtual ~SessionHost() = default;
    virtual const StreamLayout& layout() const = 0;
    virtual FrameRing& frames() = 0;
    virtual FrameCompressor& compressor() = 0;
    virtual const SensorRing& sensors() = 0;
    virtual ClientLog& log() = 0;
    virtual v1::Status status() = 0;
    virtual void start_recording(const std::string& path, RecordAnswer answer) = 0;
    virtual void stop_recording(RecordAnswer answer) = 0;
    virtual void control_camera(const v1::CameraRequest& request, CameraAnswer answer) = 0;
    virtual void subscription_changed() = 0;
    virtual void closed(std::uint64_t id) = 0;
};

/// One connection: what the client asks, what it gets, and when it is thrown out. Its memory is bounded whatever the
/// client does: one message coming in (1 MiB at most), a few answers, one frame going out and a compressed one after
/// it; frames that wait are the server's. A client that does not read stays connected and is skipped. Lives in the
/// server's thread only.
class ClientSession : public std::enable_shared_from_this<ClientSession>, public FrameCompressor::Client {
public:
    using Socket = boost::asio::generic::stream_protocol::socket;

    ClientSession(Socket socket, std::string address, std::uint64_t id, SessionHost& host);

    /// Waits for the client's Hello.
    void start();

    /// Tells the client why it is not served and closes.
    void refuse(const std::string& why);

    /// There is a new frame in the ring.
    void frame_arrived();

    /// There are new samples in the ring.
    void sensors_arrived();

    /// The frames look different from now on; products may be gone.
    void layout_changed();

    /// Closes without a word; the server is stopping.
    void stop();

    bool greeted() const { return greeted_; }
    std::uint32_t wanted() const { return closing_ ? 0 : selection_.product_bits(); }
    bool wants_sensors() const { return !closing_ && wants_sensors_; }
    v1::ClientStatus status() const;

private:
    void read_length();
    void read_message(std::uint32_t length);
    void message_arrived();
    void handle(const v1::Envelope& message);
    void hello(const v1::Hello& hello);
    void subscribe(const v1::Subscribe& subscribe);
    void send_status_every(double seconds);
    void answer_recording(const v1::RecordStatus& status, const std::string& refusal);
    void control_camera(const v1::CameraRequest& request);
    void answer_later(v1::Envelope answer, const std::string& refusal);
    void send(v1::Envelope message);
    void send_error(const std::string& why, bool closing);
    void pump();
    bool take_sensors();
    bool take_frame();
    bool take_compressed();
    FrameCompressor::Wish wish();
    FrameCompressor::Wish next_wish() override;
    bool would_wish(const FrameCompressor::Wish& wish) const override;
    void compressed(const FrameCompressor::Wish& wish, std::shared_ptr<const EncodedPlanes> planes) override;
    void not_compressed(const std::string& why) override;
    FrameHandle next_frame();
    bool clamp_region(const FrameCopy& frame, Selection& selection);
    void make_head(const FrameCompressor::Wish& wish, const EncodedPlanes& planes, std::vector<std::uint8_t>& head);
    void write();
    void drain();
    void close(const std::string& why);
    std::string label() const;

    Socket socket_;
    const std::string address_;
    const std::uint64_t id_;
    SessionHost& host_;
    boost::asio::steady_timer deadline_;  ///< for the Hello, later for the client's end of a close
    boost::asio::steady_timer status_timer_;

    std::string name_;
    bool greeted_ = false;
    bool closing_ = false;  ///< an Error with closing = true is the last thing it gets
    bool closed_ = false;

    std::array<std::uint8_t, 4> length_{};
    std::vector<std::uint8_t> incoming_;
    std::array<std::uint8_t, 4096> discarded_{};  ///< what comes after the last message; one may be on its way still
    bool reading_ = false;
    bool answer_pending_ = false;  ///< nothing more is read until that is answered

    std::deque<std::vector<std::uint8_t>> answers_;
    std::vector<std::uint8_t> head_;  ///< being written, with planes_ behind it
    std::shared_ptr<const EncodedPlanes> planes_;
    std::vector<std::uint8_t> compressed_head_;  ///< to be written next, with compressed_ behind it
    std::shared_ptr<const EncodedPlanes> compressed_;
    bool compressing_ = false;  ///< it waits for its turn, or its frame is being compressed
    bool outdated_ = false;     ///< by another subscription, what is being compressed
    bool writing_ = false;
    bool stall_logged_ = false;
    std::chrono::steady_clock::time_point write_started_;

    Selection selection_;
    bool wants_sensors_ = false;
    std::uint64_t next_sample_ = 0;
    double max_rate_ = 0;
    std::chrono::steady_clock::time_point next_due_;
    std::uint64_t next_index_ = 0;  ///< first publish index not yet looked at
    bool has_sent_ = false;
    std::uint64_t last_sent_ = 0;  ///< publish index
    std::uint64_t frames_sent_ = 0;
    std::uint64_t frames_skipped_ = 0;
    std::uint64_t bytes_sent_ = 0;
};

}  // namespace disparityd
