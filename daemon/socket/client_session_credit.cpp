// SPDX-License-Identifier: Apache-2.0
//
// What keeps a client's frames fresh: the credit that it gives, the bytes that lie unread before it, the difference of
// the clocks, and the end of a connection that it has left behind.
#include <linux/sockios.h>
#include <sys/ioctl.h>

#include "daemon/socket/client_session.h"
#include "proto/monotonic_clock.h"

namespace disparityd::daemon {
namespace {

/// So many frames may lie in the system's buffers for a client that gives no credit.
constexpr std::size_t frames_in_buffers = 4;

/// Returns the bytes that the system still holds for the client: over TCP those not sent yet, on the Unix socket those
/// not read yet, with the system's own bytes around them. What lies unread at another machine is not known here.
std::size_t held_by_system(int socket, bool local) {
    int bytes = 0;
    return ::ioctl(socket, local ? SIOCOUTQ : SIOCOUTQNSD, &bytes) == 0 && bytes > 0 ? static_cast<std::size_t>(bytes)
                                                                                     : 0;
}

}  // namespace

void ClientSession::add_credit(const v1::Ready& ready) {
    limit_apart_from_requests();
    credit_.add(ready.frames());
    ask_for_compressed();
    pump();
}

void ClientSession::answer_ping(const v1::Ping& ping) {
    limit_apart_from_requests();
    v1::Envelope answer;
    answer.mutable_pong()->set_client_ns(ping.client_ns());
    answer.mutable_pong()->set_monotonic_ns(proto::monotonic_ns());
    send(std::move(answer));
}

/// A client may send Ready with every frame, and still ask as much as others.
void ClientSession::limit_apart_from_requests() {
    requests_.give_back();
    credits_.take();
}

/// Returns whether the next frame waits: a client that gives no credit would get it behind frames of the past. The next
/// one that is published asks again, and watch() where none comes.
bool ClientSession::holds_back() {
    return !credit_.limited() && frame_bytes_ != 0 &&
           held_by_system(stream_.native_handle(), peer_.local) > frames_in_buffers * frame_bytes_;
}

void ClientSession::make_room_for(const ClientSession& newer) noexcept {
    const bool same_client = id_ != newer.id_ && greeted_ && client_id_ != 0 && client_id_ == newer.client_id_;
    if (same_client && is_open() && peer_.local == newer.peer_.local && peer_.user == newer.peer_.user &&
        peer_.certificate == newer.peer_.certificate && token_ == newer.token_) {
        close("closed: its client has connected anew");
    }
}

}  // namespace disparityd::daemon
