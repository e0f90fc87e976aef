// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/web/foxglove/session.h"
#include "bridges/web/live/answered_pace.h"
#include "bridges/web/live/live_session.h"

namespace disparityd::web {

/// One viewer that speaks Foxglove's protocol: brings the session and its connection together.
class FoxgloveLink : public MessageHandler, public Listener, public std::enable_shared_from_this<FoxgloveLink> {
public:
    /// `peer`: the visitor's address.
    FoxgloveLink(const Workplace& workplace, std::string peer);

    void on_open(MessageLink& link) override;
    void on_text(std::string_view text) override;
    void on_binary() override;
    void on_sent() override { send_next(); }
    void on_answer(std::string_view mark) override;
    void on_closed() override;
    bool wants_nothing() const override { return session_.subscribed().empty(); }
    void on_frame(const std::shared_ptr<const LiveFrame>& frame) override;
    void on_state(const DaemonState& state) override;
    void on_sensors(const disparity::SensorBatch& batch) override;
    Wants wants() const override;

private:
    void send_texts(const std::vector<std::string>& texts);
    void send_messages(const std::vector<foxglove::Message>& messages);
    void send_gone(const std::string& why);
    void send_next();
    void send_frame(const foxglove::Payloads& payloads, std::int64_t received_ns);

    Workplace place_;
    std::string peer_;
    foxglove::FoxgloveSession session_;
    std::shared_ptr<const v1::Status> status_;  ///< the newest; nullptr before the first
    MessageLink* link_ = nullptr;               ///< nullptr after the end
    std::shared_ptr<const LiveFrame> waiting_;
    std::uint64_t passed_ = 0;  ///< frames that came since the last one that was sent
    bool encoding_ = false;
    // A WebSocket and its two systems may hold megabytes that a viewer has not read.
    AnsweredPace frames_{'f'};
    AnsweredPace samples_{'s'};
};

}  // namespace disparityd::web
