import unittest

from loading import load

check_fused = load("check_fused")

DISASSEMBLY = """
motor.cpp.o:     file format elf64-x86-64

0000000000000000 <stator::plant::Motor::step(double)>:
   0:\tvmovsd (%rdi),%xmm0
   4:\t{instruction}  %xmm1,%xmm2,%xmm0
   9:\tret
"""


class CheckFused(unittest.TestCase):
    def found(self, instruction):
        return list(check_fused.find_fused(DISASSEMBLY.replace("{instruction}", instruction)))

    def test_every_form_of_a_fused_operation_is_found_with_its_place(self):
        for instruction in (
            "vfmadd213sd",
            "vfmsub132pd",
            "vfnmadd231ss",
            "vfnmsub213sd",
            "vfmaddsub132pd",
            "vfmsubadd213ps",
            "fmadd",
            "fnmsub",
            "fmla",
            "fmls",
        ):
            with self.subTest(instruction):
                self.assertEqual(
                    self.found(instruction), [("motor.cpp.o", "stator::plant::Motor::step(double)", instruction)]
                )

    def test_separate_operations_pass(self):
        for instruction in ("vmulsd", "vaddsd", "vsubpd", "vaddsubpd", "vpmaddwd", "fmul", "fmov"):
            with self.subTest(instruction):
                self.assertEqual(self.found(instruction), [])


if __name__ == "__main__":
    unittest.main()
