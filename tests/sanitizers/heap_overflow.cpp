#include <cstddef>
#include <vector>

// Reads one element past a vector; AddressSanitizer must end the program with a non-zero exit code.
// Without a sanitizer it ends with 0, whatever was read. `argc` keeps the compiler from knowing.
int main(int argc, char**) {
  const std::vector<int> numbers(static_cast<std::size_t>(argc), 0);
  const int* const past_the_end = numbers.data() + numbers.size();
  volatile int read = *past_the_end;
  static_cast<void>(read);
  return 0;
}
