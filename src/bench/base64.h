// Bytes as text that fits into a web page (RFC 4648).
#pragma once

#include <string>
#include <string_view>

namespace msf {

std::string EncodeBase64(std::string_view bytes);

}  // namespace msf
