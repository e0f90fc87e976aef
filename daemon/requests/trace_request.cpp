// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/trace_service.h"

#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "base/failure_text.h"
#include "daemon/requests/trace_message.h"

namespace disparityd::daemon {

void TraceService::ask(const v1::TraceRequest& request, Answer answer) {
    const double seconds = request.seconds();
    if (!(seconds >= least_seconds && seconds <= most_seconds)) {
        answer({}, fmt::format("trace: seconds: found {}, allowed: {} to {}", seconds, least_seconds, most_seconds));
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        if (!answer_) {
            answer_ = std::exchange(answer, {});
        }
    }
    if (answer) {
        answer({}, fmt::format("trace: another one is being taken: ask again in {} s", most_seconds));
        return;
    }
    const std::chrono::duration<double> time(seconds);
    try {
        boost::asio::post(
            control_, [this, time] { begin(std::chrono::duration_cast<std::chrono::steady_clock::duration>(time)); });
    } catch (const std::exception& error) {
        refuse(base::failure_text(error));
    }
}

void TraceService::begin(std::chrono::steady_clock::duration time) {
    try {
        const auto engine = engine_();
        if (!engine) {
            refuse("trace: the source is being prepared; ask again");
            return;
        }
        engine->tracer().begin();
        traced_ = engine;
        timer_.expires_after(time);
        timer_.async_wait([this](const boost::system::error_code& error) {
            if (!error) {
                end();
            }
        });
    } catch (const std::exception& error) {
        refuse("trace: " + base::failure_text(error));
        if (const auto engine = std::exchange(traced_, {}).lock()) {
            engine->tracer().end();  // the timer was not set
        }
    }
}

void TraceService::end() {
    try {
        const auto engine = std::exchange(traced_, {}).lock();
        if (!engine || engine != engine_()) {
            refuse("trace: the configuration was loaded again, or the source opened anew, meanwhile; ask again");
            return;
        }
        auto parts = std::make_shared<const std::vector<v1::Trace>>(to_messages(engine->tracer().end()));
        take_answer()(std::move(parts), {});
    } catch (const std::exception& error) {
        refuse("trace: " + base::failure_text(error));
    }
}

void TraceService::refuse(const std::string& why) {
    if (const Answer answer = take_answer()) {
        answer({}, why);
    }
}

TraceService::Answer TraceService::take_answer() {
    const std::lock_guard lock(mutex_);
    return std::exchange(answer_, {});
}

}  // namespace disparityd::daemon
