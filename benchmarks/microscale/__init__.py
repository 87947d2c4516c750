"""The page on the microscale: closures side by side, and what they make of friction."""
