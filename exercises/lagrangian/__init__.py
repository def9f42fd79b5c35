"""Lagrangian mechanics with sympy: equations of motion, conserved quantities, integration."""
