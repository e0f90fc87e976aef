// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "bridges/web/live/live_session.h"

namespace disparityd::web {

/// One viewer of an MJPEG stream: one image, the newest frame whenever the link is no longer busy with the one before.
/// When no more come, it gets a picture that says so: it would show the last one for ever.
class MjpegSession : public MessageHandler, public Listener, public std::enable_shared_from_this<MjpegSession> {
public:
    /// The text between two parts, as the head of the response names it.
    static constexpr const char* boundary = "disparityd-frame";

    /// `rate`: frames per second at most; 0 = all.
    /// `peer`: the visitor's address.
    MjpegSession(const Workplace& workplace, std::string peer, const ImageView& view, double rate);

    void on_open(MessageLink& link) override;
    void on_text(std::string_view) override {}
    void on_binary() override {}
    void on_sent() override { send_next(); }
    void on_closed() override;
    bool wants_nothing() const override { return false; }
    void on_frame(const std::shared_ptr<const LiveFrame>& frame) override;
    void on_state(const DaemonState& state) override;
    void on_sensors(const disparity::SensorBatch&) override {}
    Wants wants() const override;

private:
    /// What is sent as one part of the stream.
    struct Part {
        std::shared_ptr<const std::string> jpeg;  ///< nullptr: nothing
        int width = 0;                            ///< px
        int height = 0;                           ///< px
        std::uint64_t frames = 0;                 ///< that it shows: 0 or 1
        std::string facts;                        ///< lines of its head, each with its end
    };

    bool takes_a_part() const { return link_ != nullptr && !encoding_ && !link_->busy(); }
    void send_next();
    void make_and_send(std::function<Part()> make);
    void send(const Part& part);

    Workplace place_;
    std::string peer_;
    ImageView view_;
    std::chrono::nanoseconds interval_{};
    std::chrono::steady_clock::time_point next_{};
    MessageLink* link_ = nullptr;  ///< nullptr after the end
    std::shared_ptr<const LiveFrame> waiting_;
    bool encoding_ = false;
    std::chrono::steady_clock::time_point came_{};  ///< the newest frame; the epoch before the first
    std::chrono::steady_clock::duration gap_{};     ///< between it and the one before
    bool silent_ = false;                           ///< no more come, which was noticed
    int notices_due_ = 0;                           ///< so many pictures that say this are still to be sent
    int width_ = 0;                                 ///< of the last picture, px; 0 before the first
    int height_ = 0;
};

}  // namespace disparityd::web
