// Eight bytes a step with eight tables ("slicing by 8"); where the processor multiplies polynomials, 64 bytes a step by folding: the bytes
// are a polynomial over GF(2), and its upper part may be replaced by what it leaves when divided by the checksum's polynomial P,
//
//     a x^n + b  =  a (x^n mod P) + b    (mod P)
//
// which is a product of two short polynomials. Method: V. Gopal et al., "Fast CRC Computation for Generic Polynomials Using PCLMULQDQ
// Instruction", Intel, 2009. Both ways give the same checksums.
#include "runtime/gather/crc32.h"

#include <array>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace pmac::runtime {
namespace {

constexpr std::uint32_t kPolynomial = 0xedb88320u;  // bit 31 is x^0

using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1u) ? kPolynomial : 0u);
    tables[0][i] = value;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t i = 0; i < 256; ++i) tables[k][i] = (tables[k - 1][i] >> 8) ^ tables[0][tables[k - 1][i] & 0xffu];
  }
  return tables;
}

constexpr Tables kTables = make_tables();

/// crc: the register, which is the complement of a checksum.
std::uint32_t by_tables(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    const std::uint8_t* b = bytes.data() + i;
    crc = kTables[7][(crc ^ b[0]) & 0xffu] ^ kTables[6][((crc >> 8) ^ b[1]) & 0xffu] ^
          kTables[5][((crc >> 16) ^ b[2]) & 0xffu] ^ kTables[4][((crc >> 24) ^ b[3]) & 0xffu] ^ kTables[3][b[4]] ^
          kTables[2][b[5]] ^ kTables[1][b[6]] ^ kTables[0][b[7]];
  }
  for (; i < bytes.size(); ++i) crc = (crc >> 8) ^ kTables[0][(crc ^ bytes[i]) & 0xffu];
  return crc;
}

/// a * b mod P.
constexpr std::uint32_t product(std::uint32_t a, std::uint32_t b) {
  std::uint32_t sum = 0;
  for (std::uint32_t bit = 0x80000000u; bit != 0; bit >>= 1) {
    if (a & bit) sum ^= b;
    b = (b >> 1) ^ ((b & 1u) ? kPolynomial : 0u);
  }
  return sum;
}

/// x^n mod P.
constexpr std::uint32_t power_of_x(std::uint64_t n) {
  std::uint32_t result = 0x80000000u, square = 0x40000000u;  // x^0, x^1
  for (; n != 0; n >>= 1) {
    if (n & 1u) result = product(result, square);
    square = product(square, square);
  }
  return result;
}

#if defined(__x86_64__)

constexpr std::size_t kFold = 64;  // bytes a step

/// What a half of 128 bits is multiplied with to go `bits` on; reflected polynomials come out one place too low in the product.
constexpr long long factor(unsigned bits) { return static_cast<long long>(static_cast<std::uint64_t>(power_of_x(bits)) << 1); }

/// The lower half lies 64 bits before the upper one.
__attribute__((target("pclmul,sse4.1"))) inline __m128i shifted(__m128i value, __m128i factors) {
  return _mm_xor_si128(_mm_clmulepi64_si128(value, factors, 0x00), _mm_clmulepi64_si128(value, factors, 0x11));
}

__attribute__((target("pclmul,sse4.1"))) inline __m128i load(const std::uint8_t* from) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
}

/// All of a size that is a multiple of kFold, and not 0.
__attribute__((target("pclmul,sse4.1"))) std::uint32_t by_folding(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  const __m128i by_512 = _mm_set_epi64x(factor(512 - 32), factor(512 + 32)), by_128 = _mm_set_epi64x(factor(128 - 32), factor(128 + 32));
  const std::uint8_t* at = bytes.data();
  const std::uint8_t* const end = at + bytes.size();
  __m128i lane[4] = {_mm_xor_si128(load(at), _mm_cvtsi32_si128(static_cast<int>(crc))), load(at + 16), load(at + 32), load(at + 48)};
  for (at += kFold; at < end; at += kFold)
    for (int i = 0; i < 4; ++i) lane[i] = _mm_xor_si128(shifted(lane[i], by_512), load(at + 16 * i));
  __m128i rest = lane[0];
  for (int i = 1; i < 4; ++i) rest = _mm_xor_si128(shifted(rest, by_128), lane[i]);
  std::array<std::uint8_t, 16> left{};
  _mm_storeu_si128(reinterpret_cast<__m128i*>(left.data()), rest);
  return by_tables(left, 0);
}

bool can_fold() {
  static const bool can = __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("sse4.1");
  return can;
}

#endif

}  // namespace

std::uint32_t zip_crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  std::uint32_t state = ~crc;
#if defined(__x86_64__)
  const std::size_t whole = bytes.size() / kFold * kFold;
  if (whole > 0 && can_fold()) {
    state = by_folding(bytes.first(whole), state);
    bytes = bytes.subspan(whole);
  }
#endif
  return ~by_tables(bytes, state);
}

std::uint32_t joined_crc32(std::uint32_t first, std::uint32_t second, std::uint64_t second_size) {
  return product(power_of_x(8 * second_size), first) ^ second;
}

}  // namespace pmac::runtime
