// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "clients/cpp/connection.h"
#include "clients/cpp/local_daemons.h"
#include "clients/cpp/one_user.h"

namespace disparity {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Passes between two looks for a daemon that is away: at its address, and by its name, which also touches the sockets
/// of others.
constexpr milliseconds look_at_address_interval{100};
constexpr milliseconds look_for_name_interval{250};

/// A daemon that has refused is asked again after this time.
constexpr milliseconds pause_after_refusal{500};

/// A daemon has so long to answer, however little the caller wants to wait: a busy one would never be found again.
constexpr milliseconds least_patience{1000};

/// Returns the address of a socket as SocketClient takes it; empty for a name.
std::string socket_address(const std::string& where) {
    for (const char* kind : {"unix:", "tcp:", "tls:"}) {
        if (where.compare(0, 4, kind, 4) == 0) {
            return where;
        }
    }
    return where.find('/') == std::string::npos ? std::string() : "unix:" + where;
}

milliseconds left_until(Deadline deadline) {
    return std::max(milliseconds(0), std::chrono::ceil<milliseconds>(deadline - steady_clock::now()));
}

}  // namespace

class Client::Impl {
public:
    Impl(const std::string& where, const Subscription& wanted, const ClientOptions& options)
        : named_(where), address_(socket_address(where)), options_(options) {
        if (address_.empty() && !where.empty()) {
            check_daemon_name(where);
        }
        want(wanted);
        try {
            open(options_.timeout);
        } catch (const std::runtime_error& error) {
            if (!options_.may_be_absent) {
                throw;
            }
            why_gone_ = error.what();
        }
    }

    void subscribe(const Subscription& wanted) {
        const OneUser::Call call(user_);
        want(wanted);
        if (memory_ && !memory_serves()) {
            memory_.reset();  // the next read goes on over the socket
            open_ = false;
        } else if (socket_) {
            socket_->subscribe(by_socket());
        }
    }

    ReadResult read(Frame& frame, milliseconds timeout) {
        const OneUser::Call call(user_);
        const Deadline deadline = after(timeout);
        if (!found(deadline)) {
            return ReadResult::gone;
        }
        try {
            return memory_ ? read_memory(frame, deadline) : read_socket(frame, deadline);
        } catch (const std::exception& error) {
            lose();  // what a daemon refuses today it may grant tomorrow
            why_gone_ = error.what();
            look_again_ = steady_clock::now() + pause_after_refusal;
            throw;
        }
    }

    ReadResult read_sensors(SensorBatch& batch, milliseconds timeout) {
        const OneUser::Call call(user_);
        const Deadline deadline = after(timeout);
        if (!found(deadline) || !has_socket(deadline)) {
            return ReadResult::gone;
        }
        try {
            const ReadResult result = socket_->read_sensors(batch, left_until(deadline));
            return result == ReadResult::gone ? gone() : result;
        } catch (...) {
            drop_socket();
            throw;
        }
    }

    std::string status(milliseconds timeout) {
        const OneUser::Call call(user_);
        try {
            return beside(after(timeout)).status(timeout);
        } catch (...) {
            if (memory_ || wanted_.products.empty()) {
                drop_socket();  // the next call looks for it anew
            }
            throw;
        }
    }

    SocketClient& socket() {
        const OneUser::Call call(user_);
        return beside(after(options_.timeout));
    }

    std::string where() const {
        return memory_            ? "shared memory " + name_
               : !open_           ? std::string()
               : address_.empty() ? "socket of " + name_
                                  : address_;
    }
    const std::string& why_gone() const { return why_gone_; }
    bool unanswered() const { return unanswered_; }

private:
    void want(const Subscription& wanted) {
        if (wanted.status_interval_s != 0) {
            throw std::invalid_argument("status_interval_s: found " + std::to_string(wanted.status_interval_s) +
                                        ", allowed: 0; ask with status(), or subscribe with a SocketClient");
        }
        if (!std::isfinite(wanted.max_rate) || wanted.max_rate < 0) {
            throw std::invalid_argument("max_rate: found " + std::to_string(wanted.max_rate) +
                                        ", allowed: 0 (every frame) or more");
        }
        wanted_ = wanted;
        due_ = {};
        asked_memory_ = false;
    }

    /// Whether all that is wanted can come out of a shared memory.
    bool memory_serves() const { return !wanted_.products.empty() && wanted_.region_width == 0; }

    /// Returns what the socket is to send: the frames only where they do not come over shared memory.
    Subscription by_socket() const {
        Subscription subscription = wanted_;
        if (memory_) {
            subscription.products.clear();
        }
        return subscription;
    }

    /// Looks for the daemon once. Throws std::runtime_error with one line when there is none.
    void open(milliseconds timeout) {
        std::string why;
        if (address_.empty()) {
            name_ = named_.empty() ? running_daemon(options_) : named_;
            asked_memory_ = false;
            open_memory(why);
        }
        try {
            if (!memory_) {
                open_socket(timeout);
            }
        } catch (const std::runtime_error& error) {
            if (why.empty()) {
                throw;
            }
            throw std::runtime_error(std::string(error.what()) + " (" + why + ")");
        }
        open_ = true;
        unanswered_ = false;
    }

    /// Takes the shared memory where all that is wanted can come out of it. `why`: it cannot, for people.
    void open_memory(std::string& why) {
        if (memory_serves()) {
            try {
                memory_.emplace(open_memory_of(name_, options_));
            } catch (const std::runtime_error& error) {
                why = error.what();
            }
        }
    }

    void open_socket(milliseconds timeout) {
        if (!socket_) {
            socket_.emplace(address_.empty() ? connect_to(name_, options_, timeout)
                                             : SocketClient(address_, options_.reach, options_.client_name, timeout));
        }
        if (const Subscription wanted = by_socket(); !wanted.products.empty() || wanted.sensors) {
            socket_->subscribe(wanted);
        }
    }

    milliseconds pause() const { return address_.empty() ? look_for_name_interval : look_at_address_interval; }

    /// Returns the socket, whatever way the frames take.
    SocketClient& beside(Deadline deadline) {
        if (!open_) {
            open(std::max(left_until(deadline), least_patience));
        }
        if (!socket_) {
            open_socket(std::max(left_until(deadline), least_patience));
        }
        return *socket_;
    }

    /// As beside(), for one who waits: returns false where no socket answers, and then not at once.
    bool has_socket(Deadline deadline) {
        try {
            beside(deadline);
            return true;
        } catch (const std::runtime_error& error) {
            why_gone_ = error.what();
            std::this_thread::sleep_until(std::min(deadline, steady_clock::now() + pause()));
            return false;
        }
    }

    /// Looks for a daemon until the deadline where there is none. Throws what refuses until then.
    bool found(Deadline deadline) {
        std::exception_ptr refusal;
        while (!open_) {
            std::this_thread::sleep_until(std::min(deadline, look_again_));
            if (steady_clock::now() < look_again_) {
                return false;
            }
            try {
                open(std::clamp(left_until(deadline), least_patience, std::max(options_.timeout, least_patience)));
                break;
            } catch (const std::invalid_argument& error) {  // a file that was right before
                why_gone_ = error.what();
                refusal = std::make_exception_ptr(std::runtime_error(error.what()));
            } catch (const std::runtime_error& error) {
                why_gone_ = error.what();
                refusal = dynamic_cast<const Refused*>(&error) != nullptr ? std::current_exception() : nullptr;
            }
            look_again_ = steady_clock::now() + pause();
            if (refusal && look_again_ >= deadline) {
                std::rethrow_exception(refusal);
            }
        }
        return true;
    }

    ReadResult read_memory(Frame& frame, Deadline deadline) {
        // max_rate, as the daemon keeps it over the socket: a little early is on time.
        const auto interval = std::chrono::duration_cast<steady_clock::duration>(
            std::chrono::duration<double>(wanted_.max_rate > 0 ? 1 / std::max(wanted_.max_rate, 1e-6) : 0));
        const auto due = due_ - interval / 20;
        std::this_thread::sleep_until(std::min(deadline, due));
        if (steady_clock::now() < due) {
            return ReadResult::timeout;
        }
        const ReadResult result = memory_->read(frame, left_until(deadline), wanted_.products);
        if (result == ReadResult::frame) {
            const auto now = steady_clock::now();
            due_ = (due_ + interval > now ? due_ : now) + interval;
        } else if (result == ReadResult::gone) {
            why_gone_ = memory_->why_gone();
            lose();
        }
        return result;
    }

    ReadResult read_socket(Frame& frame, Deadline deadline) {
        const ReadResult result = socket_->read(frame, left_until(deadline));
        if (result == ReadResult::gone) {
            return gone();
        }
        // A daemon that publishes has its shared memory, if it has one at all.
        if (result == ReadResult::frame && address_.empty() && !std::exchange(asked_memory_, true)) {
            go_on_over_memory(frame);
        }
        return result;
    }

    /// Takes the shared memory where it has this frame of the socket, or a newer one, which is then given in its place.
    void go_on_over_memory(Frame& frame) {
        std::string why;
        open_memory(why);
        Frame newest;
        if (memory_ && memory_->read(newest, milliseconds(0), wanted_.products) == ReadResult::frame &&
            newest.publish_index >= frame.publish_index) {
            newest.skipped = frame.skipped + (newest.publish_index - frame.publish_index);
            frame = std::move(newest);
            socket_->subscribe(by_socket());
        } else {
            memory_.reset();
        }
    }

    /// Says that the socket has ended.
    ReadResult gone() {
        why_gone_ = socket_->why_gone();
        unanswered_ = socket_->unanswered();
        if (address_.empty()) {
            drop_socket();  // its daemon may come back elsewhere
        }
        return ReadResult::gone;
    }

    void drop_socket() {
        socket_.reset();
        open_ = memory_.has_value();
    }

    void lose() {
        memory_.reset();
        socket_.reset();
        open_ = false;
    }

    OneUser user_{"Client"};
    std::string named_;    ///< as the caller has said
    std::string address_;  ///< of the socket that the caller has named; empty: a daemon of this machine
    ClientOptions options_;
    Subscription wanted_;
    std::string name_;           ///< of the daemon of this machine that was found
    bool open_ = false;          ///< frames can come
    bool asked_memory_ = false;  ///< a shared memory was looked for since frames come over the socket
    std::optional<SharedMemoryReader> memory_;
    std::optional<SocketClient> socket_;
    steady_clock::time_point look_again_;  ///< for a daemon, not before
    steady_clock::time_point due_;         ///< the next frame, where max_rate is wanted
    std::string why_gone_;
    bool unanswered_ = false;
};

Client::Client(const std::string& where, const Subscription& wanted, const ClientOptions& options)
    : impl_(std::make_unique<Impl>(where, wanted, options)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

void Client::subscribe(const Subscription& wanted) {
    impl_->subscribe(wanted);
}
ReadResult Client::read(Frame& frame, milliseconds timeout) {
    return impl_->read(frame, timeout);
}
ReadResult Client::read_sensors(SensorBatch& batch, milliseconds timeout) {
    return impl_->read_sensors(batch, timeout);
}
std::string Client::status(milliseconds timeout) {
    return impl_->status(timeout);
}
SocketClient& Client::socket() {
    return impl_->socket();
}
std::string Client::where() const {
    return impl_->where();
}
const std::string& Client::why_gone() const {
    return impl_->why_gone();
}
bool Client::unanswered() const {
    return impl_->unanswered();
}

Client connect(const std::string& where, const Subscription& wanted, const ClientOptions& options) {
    return Client(where, wanted, options);
}

}  // namespace disparity
