// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

/// Whether a datagram that is sent to 127.0.0.1 arrives: in some containers none does.
bool loopback_carries_datagrams();

}  // namespace disparityd::test
