// Examination.
