// SPDX-License-Identifier: Apache-2.0
#include "daemon/configured_access.h"

#include <stdexcept>

namespace disparityd::daemon {

ClientAccess client_access(const Config& config) {
    ClientAccess access;
    access.tcp_control = config.socket.tcp_control;
    access.certificates = !config.socket.client_authority.empty();
    if (!config.socket.tokens.empty()) {
        try {
            access.tokens = base::read_tokens(config.socket.tokens);
        } catch (const std::invalid_argument& error) {
            throw std::invalid_argument(std::string("[socket] tokens: ") + error.what());
        }
    }
    access.control_certificates = config.access.control_certificates;
    access.view_groups = find_groups(config.access.view_groups, "[access] view_groups");
    access.control_groups = find_groups(config.access.control_groups, "[access] control_groups");
    return access;
}

proto::TlsContext client_tls(const Config& config) {
    if (config.socket.certificate.empty()) {
        return nullptr;
    }
    try {
        base::check_secret_file(config.socket.key, "the key");
        proto::TlsContext context = proto::make_server_tls(
            {config.socket.certificate, config.socket.key, config.socket.client_authority}, "disparityd");
        // Each connection shows its certificate anew, so that a reload reaches all clients.
        SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
        SSL_CTX_set_options(context.get(), SSL_OP_NO_TICKET);
        SSL_CTX_set_num_tickets(context.get(), 0);
        return context;
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(std::string("[socket] ") + error.what());
    }
}

}  // namespace disparityd::daemon
