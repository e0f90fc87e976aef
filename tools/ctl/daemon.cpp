// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/daemon.h"

#include "tools/command_line/program.h"

namespace disparityd::tools {

disparity::Client connect(const DaemonArguments& daemon, const std::vector<disparity::Product>& products,
                          std::chrono::milliseconds timeout) {
    disparity::Subscription wanted;
    wanted.products = products;
    disparity::ClientOptions options = daemon.reach.for_client("disparityctl");
    options.timeout = timeout;
    options.note = print_note;
    return disparity::connect(daemon.where(), wanted, options);
}

std::string command_of(const DaemonArguments& daemon, const std::string& words) {
    return daemon.command("disparityctl " + words);
}

}  // namespace disparityd::tools
