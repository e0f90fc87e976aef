// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/certificates/certificate.h"

namespace disparityd::tools {

/// Returns the authority's list of revoked certificates (RFC 5280, section 5) as PEM: those of `before`, a list of this
/// authority or empty, and `certificates`. The list is valid as long as the authority. Throws std::invalid_argument
/// with one line for a certificate that is of another authority or revoked already, or a list that cannot be used.
std::string revocation_list(const Certificate& authority, const std::string& before,
                            const std::vector<const X509*>& certificates);

/// Puts NAME.crt of a folder of make_certificate_files() on the list, which stands in its authority.crt behind the
/// certificate. The file is replaced at once by one of the same mode. Throws as revocation_list(), before anything is
/// written; std::runtime_error when the system refuses.
void revoke_certificates(const std::string& folder, const std::vector<std::string>& names);

}  // namespace disparityd::tools
