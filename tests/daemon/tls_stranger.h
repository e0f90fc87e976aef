// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "proto/tls/tls_stream.h"
#include "tests/daemon/wire_client.h"

namespace disparityd::test {

/// A connection to a port with TLS that goes on as far as chance wants: through the handshake, Hello and Subscribe,
/// each in pieces. It ends anywhere: it leaves, resets, or sends what nobody expects. It never waits.
class Stranger {
public:
    /// "tls:127.0.0.1:1234". `token`: of its Hello.
    Stranger(const std::string& address, const proto::TlsContext& context, std::string token, std::mt19937& chance);

    /// Does the next small thing. False: it has ended, and the object is of no more use.
    bool step();

    /// Whether it was let in before it ended.
    bool was_let_in() const { return let_in_; }

private:
    enum class Ending { leave, reset, no_tls, half_hello, noise, shut_output };
    void end_as(Ending ending);
    void send_raw(const std::vector<std::uint8_t>& bytes);
    bool send_next();
    bool read();

    WireClient connection_;
    proto::TlsStream tls_;
    std::mt19937& chance_;
    std::vector<std::uint8_t> to_send_;  ///< Hello and Subscribe
    bool hands_shaken_ = false;
    bool let_in_ = false;
    bool garbled_ = false;  ///< leaves next
};

}  // namespace disparityd::test
