#include <iostream>

#include <voroform/cvt/tessellate.hpp>
#include <voroform/implicit/shapes.hpp>
#include <voroform/mesh/validate.hpp>

int main() {
  const auto torus = voroform::implicit::torus(1.0, 0.4);

  voroform::cvt::TessellateOptions options;
  options.sites = 500;
  const auto result = voroform::cvt::tessellate(*torus, {}, options, {});

  const auto certificate = voroform::mesh::validate(result.complex, {}, {});
  std::cout << result.complex.cellCount << " cells, Euler number " << certificate.eulerCharacteristic << ", "
            << (certificate.valid ? "valid" : "not valid") << '\n';
  return certificate.valid ? 0 : 1;
}
