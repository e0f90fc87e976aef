// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "bridges/web/live/live_session.h"

namespace disparityd::web {

/// One viewer of an MJPEG stream: one image, the newest frame whenever the link is no longer busy with the one before.
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
    void on_state(const DaemonState&) override {}
    void on_sensors(const disparity::SensorBatch&) override {}
    Wants wants() const override;

private:
    void send_next();
    void send(const std::shared_ptr<const EncodedImage>& image, double captured_s);

    Workplace place_;
    std::string peer_;
    ImageView view_;
    std::chrono::nanoseconds interval_{};
    std::chrono::steady_clock::time_point next_{};
    MessageLink* link_ = nullptr;  ///< nullptr after the end
    std::shared_ptr<const LiveFrame> waiting_;
    bool encoding_ = false;
};

}  // namespace disparityd::web
